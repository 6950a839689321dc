#include <fmt/format.h>
#include <imgui.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <initializer_list>
#include <string_view>

#include "apps/rilievo/view_state.h"

namespace rilievo::app {
namespace {

void plot(const char* label, const History& history, const char* unit) {
  const std::string overlay = fmt::format("{} {:.1f} {}", label, history.last(), unit);
  ImGui::PlotLines(fmt::format("##{}", label).c_str(), history.data(), history.size(), 0,
                   overlay.c_str(), 0.0f, 1.1f * history.largest() + 1e-3f,
                   ImVec2(ImGui::GetContentRegionAvail().x, 44));
}

void camera_panel(ViewState& state) {
  int mode = int(state.mode);
  ImGui::RadioButton("fly", &mode, int(ViewMode::fly));
  ImGui::SameLine();
  ImGui::RadioButton("orbit", &mode, int(ViewMode::orbit));
  ImGui::SameLine();
  ImGui::RadioButton("play path", &mode, int(ViewMode::play));
  state.mode = ViewMode(mode);
  if (state.mode == ViewMode::play)
    ImGui::SliderInt("frame", &state.path_frame, 0, state.path_frames - 1, "%d",
                     ImGuiSliderFlags_AlwaysClamp);
  if (state.mode == ViewMode::fly) {
    ImGui::SliderFloat("m/s", &state.speed, 0.01f, 1000.0f, "%.2f",
                       ImGuiSliderFlags_Logarithmic | ImGuiSliderFlags_AlwaysClamp);
    ImGui::TextDisabled("W A S D Q E, drag to look");
  }
  if (state.mode == ViewMode::orbit) ImGui::TextDisabled("drag to turn, wheel to come closer");
  if (ImGui::Button("Set key")) {
    const double time = double(state.recorded.keys.size());
    state.recorded.keys.push_back(look_key(time, state.pose.eye,
                                           state.pose.eye + forward_of(state.pose),
                                           up_of(state.pose), state.vertical_fov));
  }
  ImGui::SameLine();
  if (ImGui::Button(fmt::format("Forget {}###forget", state.recorded.keys.size()).c_str()))
    state.recorded.keys.clear();
  if (ImGui::Button("Save path")) state.save_path = true;
  ImGui::SameLine();
  if (ImGui::Button("Screenshot")) state.save_screenshot = true;
}

// Is the method one of these?
bool is_one_of(const ViewState& state, std::initializer_list<std::string_view> names) {
  return std::find(names.begin(), names.end(), state.method) != names.end();
}

// A number of MethodOptions. True when it was changed and let go.
bool slider(const char* name, double& value, float least, float most, const char* format,
            ImGuiSliderFlags flags = 0) {
  float now = float(value);
  if (ImGui::SliderFloat(name, &now, least, most, format, flags | ImGuiSliderFlags_AlwaysClamp))
    value = now;
  return ImGui::IsItemDeactivatedAfterEdit();
}

// The options of methods that are no kinds. The cache and auto take most of them over from frame to
// frame; what others change makes them anew, when the slider is let go.
void method_options(ViewState& state) {
  MethodOptions& options = state.methods;
  const bool caches = is_one_of(state, {"cache", "auto"});
  const bool pictures = is_one_of(state, {"flat", "nailboard"});
  if (caches || state.method == "lod")
    state.new_source |=
        slider("error, px", options.error_px, 0.1f, 8, "%.2f", ImGuiSliderFlags_Logarithmic) &&
        !caches;
  if (caches)
    slider("captures, ms", options.capture_ms, 0, 50,
           options.capture_ms > 0 ? "%.1f" : "by triangles");
  if (pictures) state.new_source |= slider("angle, deg", options.angle_degrees, 0, 10, "%.2f");
  if (caches || pictures) {
    // The memory is taken at once.
    ImGui::SliderInt("memory, MB", &options.memory_mb, 32, 1024, "%d",
                     ImGuiSliderFlags_AlwaysClamp);
    state.new_source |= ImGui::IsItemDeactivatedAfterEdit();
  }
  if (state.method == "auto") {
    slider("enough fps", options.fps, 0, 240, options.fps > 0 ? "%.0f" : "as can be");
    slider("loss, dB", options.loss_db, 0, 20, "%.1f");
  }
  if (state.method == "keyframes")
    state.new_source |= slider("keyframe, ms", options.keyframe_ms, 0, 50,
                               options.keyframe_ms > 0 ? "%.1f" : "a share");
  constexpr std::array bits{2, 4, 6, 8, 16};
  if ((pictures || state.method == "cache") &&
      ImGui::BeginCombo("bits of Delta", std::to_string(options.delta_bits).c_str())) {
    for (const int b : bits) {
      if (!ImGui::Selectable(std::to_string(b).c_str(), b == options.delta_bits)) continue;
      options.delta_bits = b;
      state.new_source = true;
    }
    ImGui::EndCombo();
  }
  bool linear = options.depth_mode == DepthMode::linear;
  if (is_one_of(state, {"nailboard", "cache"}) && ImGui::Checkbox("linear depth", &linear)) {
    options.depth_mode = linear ? DepthMode::linear : DepthMode::exact;
    state.new_source = true;
  }
}

// The options of a kind, as its row of the list says. Is the source another one after a change?
bool option_controls(const Kind& kind, KindOptionsOf which, KindOptions& kinds) {
  GivenOptions& values = given_of(kinds, which);
  bool changed = false;
  for (const Option& option : options_of(kind, which)) {
    const std::string name(option.name), key = given_name(kind, option.name);
    const auto given = values.find(key);
    const std::string now =
        given == values.end() ? std::string(option.default_value) : given->second;
    const auto set = [&](const std::string& value) {
      values[key] = value;
      changed = true;
    };
    if (option.type == OptionType::flag) {
      bool on = now == "on";
      if (ImGui::Checkbox(name.c_str(), &on)) set(on ? "on" : "off");
    } else if (option.type == OptionType::choice) {
      if (ImGui::BeginCombo(name.c_str(), now.c_str())) {
        for (const std::string_view choice : option.choices)
          if (ImGui::Selectable(std::string(choice).c_str(), choice == now))
            set(std::string(choice));
        ImGui::EndCombo();
      }
    } else if (option.type == OptionType::integer) {
      int value = std::atoi(now.c_str());
      ImGui::InputInt(name.c_str(), &value);
      if (ImGui::IsItemDeactivatedAfterEdit())
        set(std::to_string(std::clamp(value, int(option.min), int(option.max))));
    } else if (option.type == OptionType::number) {
      double value = std::atof(now.c_str());
      ImGui::InputDouble(name.c_str(), &value);
      if (ImGui::IsItemDeactivatedAfterEdit() && std::isfinite(value))
        set(fmt::format("{}", std::clamp(value, option.min, option.max)));
    }
    if (ImGui::IsItemHovered())
      ImGui::SetTooltip("%.*s", int(option.help.size()), option.help.data());
  }
  return changed;
}

void method_panel(ViewState& state) {
  if (ImGui::BeginCombo("method", state.method.c_str())) {
    for (const std::string& name : state.method_names) {
      if (!ImGui::Selectable(name.c_str(), name == state.method)) continue;
      state.method = name;
      state.new_source = true;
    }
    ImGui::EndCombo();
  }
  const Kind* kind = kind_method(state.method).kind;
  if (kind) {
    state.new_source |= option_controls(*kind, KindOptionsOf::draw, state.methods.kinds);
    if (state.can_split)
      state.new_source |= option_controls(*kind, KindOptionsOf::bake, state.methods.kinds);
  }
  const bool pictures =
      kind || is_one_of(state, {"flat", "nailboard", "cache", "auto", "relief-impostor"});
  // A cache keeps its pictures.
  if (pictures && ImGui::Checkbox("outlines", &state.methods.outlines) &&
      !is_one_of(state, {"cache", "auto"}))
    state.new_source = true;
  if (state.mode == ViewMode::play || state.moves) ImGui::Checkbox("animate", &state.animate);
  if (!state.can_split) return;
  method_options(state);
  ImGui::Checkbox("split", &state.split);
  if (ImGui::IsItemHovered()) ImGui::SetTooltip("direct drawing in the right part of the window");
  if (state.split)
    ImGui::SliderFloat("at", &state.split_at, 0.0f, 1.0f, "%.2f", ImGuiSliderFlags_AlwaysClamp);
}

const char* shown_as(const ImpostorStatus& status) {
  if (!status.in_view) return "out of view";
  switch (status.frame.shown) {
    case ImpostorShown::fresh:
      return "fresh";
    case ImpostorShown::stale:
      return "stale";
    case ImpostorShown::object:
      return "polygons";
    case ImpostorShown::nothing:
      break;
  }
  return "nothing";
}

// Each impostor: what is shown of it, how stretched its picture is, how far off its warp, how old.
void impostor_panel(const ViewState& state) {
  if (state.impostors.empty() ||
      !ImGui::CollapsingHeader("impostors", ImGuiTreeNodeFlags_DefaultOpen))
    return;
  // As wide as what they show.
  constexpr ImGuiTableFlags look =
      ImGuiTableFlags_ScrollY | ImGuiTableFlags_SizingFixedFit | ImGuiTableFlags_RowBg;
  if (!ImGui::BeginTable("impostors", 6, look, ImVec2(0, 180))) return;
  ImGui::TableSetupScrollFreeze(0, 1);
  for (const char* name : {"object", "shown   ", "stretch", "off, px", "age, s", "working  "})
    ImGui::TableSetupColumn(name);
  ImGui::TableHeadersRow();
  for (const ImpostorStatus& status : state.impostors) {
    const ImpostorFrame& frame = status.frame;
    const auto cell = [](const std::string& text) {
      ImGui::TableNextColumn();
      ImGui::TextUnformatted(text.c_str());
    };
    cell(fmt::format("#{}", status.object));
    cell(shown_as(status));
    const bool has = frame.picture > 0;
    cell(has ? fmt::format("{:.2f}", frame.stretch) : "");
    cell(has ? fmt::format("{:.1f}", std::max(frame.moved_px, frame.deformed_px)) : "");
    cell(frame.age_ms > 0 ? fmt::format("{:.1f}", frame.age_ms / 1e3) : "");
    cell(frame.rendering ? "rendering" : frame.warping ? "warping" : "");
  }
  ImGui::EndTable();
}

}  // namespace

void show_panel(ViewState& state) {
  if (state.split) {
    const ImVec2 size = ImGui::GetIO().DisplaySize;
    const float x = std::floor(state.split_at * size.x);
    constexpr ImU32 white = IM_COL32(255, 255, 255, 200);
    ImDrawList& over = *ImGui::GetBackgroundDrawList();
    over.AddLine(ImVec2(x, 0), ImVec2(x, size.y), white);
    const float width = ImGui::CalcTextSize(state.method.c_str()).x;
    over.AddText(ImVec2(x - width - 8, size.y - 24), white, state.method.c_str());
    over.AddText(ImVec2(x + 8, size.y - 24), white, "direct");
  }
  ImGui::SetNextWindowPos(ImVec2(12, 12), ImGuiCond_FirstUseEver);
  // At most a third of the window; what is longer is scrolled.
  const ImVec2 window = ImGui::GetIO().DisplaySize;
  const float width = std::min(430.0f, std::floor(window.x / 3 - 12));
  ImGui::SetNextWindowSize(ImVec2(width, 0), ImGuiCond_FirstUseEver);
  ImGui::SetNextWindowSizeConstraints(ImVec2(0, 0), ImVec2(window.x, window.y - 24));
  ImGui::Begin("Rilievo");
  ImGui::PushItemWidth(0.5f * ImGui::GetContentRegionAvail().x);
  camera_panel(state);
  ImGui::Separator();
  method_panel(state);
  ImGui::Separator();
  plot("frame", state.frame_ms, "ms");
  if (state.split) plot("direct", state.direct_ms, "ms");
  plot("captures", state.captures, "a frame");
  plot("pictures", state.megabytes, "MB");
  ImGui::Text("%d polygons, %d pictures of groups", state.stats.polygons, state.stats.groups);
  for (const auto& [kind, count] : state.stats.by_kind)
    if (count > 0) ImGui::Text("%d %.*s", count, int(kind.size()), kind.data());
  impostor_panel(state);
  if (!state.stats.decision.method.empty())
    ImGui::TextWrapped("%s", state.stats.decision.sentence().c_str());
  if (state.stats.bound_px.value_or(0) > 0)
    ImGui::Text("error bound %.2f pixels", *state.stats.bound_px);
  if (!state.message.empty()) ImGui::TextWrapped("%s", state.message.c_str());
  ImGui::PopItemWidth();
  ImGui::End();
}

}  // namespace rilievo::app
