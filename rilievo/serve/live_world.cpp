#include "rilievo/serve/live_world.h"

#include <algorithm>
#include <cmath>
#include <deque>
#include <map>
#include <mutex>
#include <optional>
#include <stop_token>
#include <utility>
#include <vector>

#include "rilievo/core/background.h"
#include "rilievo/core/expects.h"
#include "rilievo/core/stopwatch.h"
#include "rilievo/keyframes/keyframe.h"
#include "rilievo/serve/forecast.h"
#include "rilievo/serve/live_picture.h"
#include "rilievo/serve/view_need.h"

namespace rilievo {
namespace {

// Pictures that a client is known to hold: the newest.
constexpr std::size_t kMostHeld = 64;
// A client to which no picture could be made waits so long.
constexpr double kAfterFailure = 1;
// A picture is made for where the eye will be when the next one is due, at most so much later.
constexpr double kMostHold = 0.6;
// Texels of coarse pictures for each pixel, in each direction; and of surrounds' faces for each
// line of the frame.
constexpr double kCoarseTexels = 0.5, kSurroundTexels = 0.6;
// A picture is so much wider than what looks are expected to see, and so wide at most: its sides'
// tangents over the frame's, and in radians.
constexpr double kLookMargin = 1.1, kWidest = 3, kHighest = 1.7, kMostSide = 1.25;
// The eye may go on beyond where a picture was due: latency and the next one take time.
constexpr double kBeyondDue = 1.5;
// The longest cell, in what is typically seen: where all is far a cell would have no end.
constexpr double kLongestCell = 0.25;
// A picture that waited longer says that the client is slow, and one that waited less that it is
// quick: it gets a lower or a higher quality.
constexpr double kLongWait = 0.15, kShortWait = 0.03;
constexpr int kQualityStep = 8, kLeastQuality = 45, kSurroundQuality = 75, kStillQuality = 92;
// The share of the newest in means.
constexpr double kNewest = 0.3;
// Kept pictures are shown to others whose eyes are off by this share of what is due.
constexpr double kShareWithin = 0.5;
constexpr double kCores = 2;
// Seconds that count for a client that has just got a picture.
constexpr double kLeastAge = 0.05;
// What waits is not replaced before it is so old.
constexpr double kFresh = 0.1;

// A picture on its way.
struct Waiting {
  std::shared_ptr<const MadePicture> picture;
  LivePictureHead head;
  double ready_at = 0;  // seconds
};

struct Client {
  LiveHello hello;
  bool greeted = false, gone = false;
  std::optional<LivePose> pose;
  PoseHistory history;
  double pose_at = 0;
  std::deque<LiveMessage> control;
  std::optional<Waiting> waiting;
  std::vector<HeldPicture> held;
  double wait_s = 0;         // that pictures waited, a mean
  int quality = 0;           // 0: the best
  double blocked_until = 0;  // no picture could be made
  double served_at = -1;     // when it got its last picture
  bool coarse_last = false;  // of views
  // The surround's eye, and its first face.
  std::uint64_t surround_id = 0;
  glm::dvec3 surround_eye{0.0};
};

HeldPicture held_of(const MadePicture& picture, std::uint64_t id) {
  return {id, picture.camera, picture.typical_inverse_z, picture.head.fine,
          picture.head.surround_face};
}

// A side at a tangent where looks are off by an angle, over the frame's.
double margin_for(double tangent, double off, double least) {
  const double own = std::atan(tangent), side = std::min(own + off, std::max(kMostSide, own));
  return std::clamp(kLookMargin * std::tan(side) / tangent, least, std::max(kWidest, least));
}

LiveMessage message_of(const ServerMessage& message) {
  return std::make_shared<const std::vector<std::byte>>(encode_message(message));
}

// Who gets a picture, and which.
struct Choice {
  std::shared_ptr<Client> client;
  ViewNeed need;
  LivePictureOrder order;
  Camera target;  // the frame that the picture is made for
  std::uint32_t sequence = 0;
  std::uint64_t kept = 0;  // a picture that is kept; 0: it is made
  double lead = 0;         // seconds until it is seen
};

}  // namespace

struct LiveWorld::State {
  CaptureSource &source, &quick;
  LiveScene scene;
  LiveWorldOptions options;

  mutable std::mutex mutex;  // of all that follows
  std::vector<std::shared_ptr<Client>> clients;
  std::map<std::uint64_t, std::shared_ptr<const MadePicture>> kept;  // the oldest first
  std::uint64_t next_id = 1;
  double view_s = 0.1;  // that a fine picture takes, a mean
  LiveWorldStats stats;
  bool running = false, stopping = false;

  std::function<double()> clock;
  std::function<void()> ready;
  std::stop_source stop;
  CaptureControl control;
  std::optional<Background> background;

  State(CaptureSource& of, CaptureSource& quick_one, const LiveScene& shown,
        const LiveWorldOptions& how)
      : source(of), quick(quick_one), scene(shown), options(how) {
    control.stop = stop.get_token();
  }

  Result<> receive(const std::shared_ptr<Client>& client, const ClientMessage& message, double now);
  void kick();
  void run_all();
  double step(double now, bool timed);
  [[nodiscard]] std::optional<Choice> choose(double now) const;
  [[nodiscard]] LivePictureOrder order_for(Client& client, const LivePose& at, const ViewNeed& need,
                                           double lead, int queue, Camera& target) const;
  [[nodiscard]] std::uint64_t find_kept(const Client& client, const Choice& choice,
                                        const LivePose& arrival) const;
  void deliver(const Choice& choice, std::shared_ptr<const MadePicture> picture, std::uint64_t id,
               double now, double ready_at);
  void keep(std::uint64_t id, const std::shared_ptr<const MadePicture>& picture);
};

namespace {

// A client, to the sockets.
class WorldSession final : public LiveSession {
 public:
  WorldSession(std::shared_ptr<LiveWorld::State> state, std::shared_ptr<Client> client)
      : state_(std::move(state)), client_(std::move(client)) {}
  ~WorldSession() override {
    const std::lock_guard lock(state_->mutex);
    client_->gone = true;
    std::erase(state_->clients, client_);
    state_->stats.clients = int(state_->clients.size());
  }

  Result<> receive(std::span<const std::byte> message, double now) override {
    const Result<ClientMessage> read = parse_client_message(message);
    if (!read) return read.error();
    return state_->receive(client_, *read, now);
  }

  LiveMessage next(double now) override {
    std::unique_lock lock(state_->mutex);
    if (!client_->control.empty()) {
      LiveMessage message = std::move(client_->control.front());
      client_->control.pop_front();
      return message;
    }
    if (!client_->waiting || client_->waiting->ready_at > now) return nullptr;
    Client& client = *client_;
    const Waiting sent = *std::exchange(client.waiting, std::nullopt);
    const double waited = now - sent.ready_at;
    client.wait_s += kNewest * (waited - client.wait_s);
    const int best = state_->options.quality;
    int& quality = client.quality = client.quality == 0 ? best : client.quality;
    if (waited > kLongWait)
      quality = std::max(quality - kQualityStep, std::min(kLeastQuality, best));
    if (waited < kShortWait) quality = std::min(quality + kQualityStep / 2, best);
    client.held.push_back(held_of(*sent.picture, sent.head.id));
    if (client.held.size() > kMostHeld) client.held.erase(client.held.begin());
    state_->kick();
    lock.unlock();
    return std::make_shared<const std::vector<std::byte>>(encode_picture(*sent.picture, sent.head));
  }

  LiveMessage last(LiveEnd why) override { return message_of(LiveBye{why}); }

 private:
  std::shared_ptr<LiveWorld::State> state_;
  std::shared_ptr<Client> client_;
};

}  // namespace

Result<> LiveWorld::State::receive(const std::shared_ptr<Client>& client,
                                   const ClientMessage& message, double now) {
  const std::lock_guard lock(mutex);
  if (const auto* hello = std::get_if<LiveHello>(&message)) {
    client->hello = *hello;
    client->greeted = true;
  } else if (!client->greeted) {
    return Error{"message", "a hello comes first"};
  } else if (const auto* pose = std::get_if<LivePose>(&message)) {
    client->pose = *pose;
    client->history.see(*pose);
    client->pose_at = now;
  } else if (const auto* have = std::get_if<LiveHave>(&message)) {
    for (const std::uint64_t id : have->ids)
      if (const auto found = kept.find(id); found != kept.end() && client->held.size() < kMostHeld)
        client->held.push_back(held_of(*found->second, id));
  } else if (const auto* dropped = std::get_if<LiveDropped>(&message)) {
    std::erase_if(client->held, [&](const HeldPicture& one) {
      return std::ranges::find(dropped->ids, one.id) != dropped->ids.end();
    });
  } else if (const auto* ping = std::get_if<LivePing>(&message)) {
    // Answers to somebody who does not read do not pile up.
    if (client->control.size() < 8)
      client->control.push_back(message_of(LivePong{ping->client_ms, 1e3 * now}));
  }
  kick();
  return Done{};
}

// Requires the mutex.
void LiveWorld::State::kick() {
  if (!background || running || stopping) return;
  running = true;
  background->run([this] { run_all(); });
}

void LiveWorld::State::run_all() {
  while (step(clock(), false) > 0) ready();
}

LivePictureOrder LiveWorld::State::order_for(Client& client, const LivePose& at,
                                             const ViewNeed& need, double lead, int queue,
                                             Camera& target) const {
  LivePictureOrder order;
  const double cell = at.cell > 0 ? at.cell : options.cell;
  Camera frame = need.frame;
  order.frame = frame_scale(frame);
  order.sky = scene.sky, order.time = scene.time, order.error_px = options.error_px;
  order.quality = client.quality == 0 ? options.quality : client.quality;
  order.control = &control;
  const double typical = client.held.empty() ? 0 : client.held.back().typical_inverse_z;
  const double longest =
      kLongestCell * std::max(double(scene.bounds.radius()), 4 * scene.start.z_near);
  const double due = std::min(due_distance(typical, cell, frame), longest);
  order.cell = kBeyondDue * due;
  if (need.wanted == Wanted::surround) {
    order.surround_face = need.face;
    order.quality = std::min(order.quality, kSurroundQuality);
    const int texels = std::clamp(int(kSurroundTexels * frame.height), 64,
                                  std::min(client.hello.largest_texture, 2048));
    // Faces of one surround have one eye, if it is still of use.
    glm::dvec3 eye = at.eye;
    if (client.surround_id != 0 && glm::length(client.surround_eye - eye) < due)
      eye = client.surround_eye;
    order.camera = surround_camera(eye, need.face, texels, frame.z_near, frame.z_far);
    return order;
  }
  order.fine = need.wanted != Wanted::coarse_view;
  if (need.wanted == Wanted::exact_view) order.quality = std::max(order.quality, kStillQuality);
  const int largest = std::min(client.hello.largest_texture, 4096);
  KeyframeMargin margin = 1.1;
  if (need.wanted != Wanted::exact_view) {
    // As far ahead as views are due, so that the eye is between two of them.
    const double speed = order.fine ? glm::length(at.velocity) : 0;
    // Where others wait, too, the next one comes after all of theirs: the middle of that time.
    const double turn = 0.5 * queue * view_s;
    const double hold = speed > 0 ? std::min(std::max(due / speed, turn), kMostHold) : 0;
    const Forecast of = client.history.forecast(lead, lead + hold);
    LivePose later = of.pose;
    later.eye = client.history.forecast(lead + hold, lead + hold).pose.eye;
    const Camera moved = camera_of(later, client.hello, frame.z_near, frame.z_far);
    frame.world_from_eye = moved.world_from_eye;
    margin = {margin_for(frame.window.right, of.yaw, options.margin),
              margin_for(frame.window.top, of.pitch, options.margin)};
    // Rather less margin than larger texels.
    margin.x = std::min(margin.x, std::max(double(largest) / frame.width, options.margin));
  }
  target = frame;
  const double texels = order.fine ? 1 : kCoarseTexels;
  order.camera = keyframe_camera(frame, margin, texels);
  if (std::max(order.camera.width, order.camera.height) > largest)
    order.camera = keyframe_camera(
        frame, margin,
        texels * largest / (std::max(order.camera.width, order.camera.height) + 1.0));
  return order;
}

// Requires the mutex.
std::uint64_t LiveWorld::State::find_kept(const Client& client, const Choice& choice,
                                          const LivePose& arrival) const {
  if (choice.need.wanted == Wanted::exact_view) return 0;
  const double cell = client.pose->cell > 0 ? client.pose->cell : options.cell;
  for (auto one = kept.rbegin(); one != kept.rend(); ++one) {
    const HeldPicture held = held_of(*one->second, one->first);
    if (held.face != choice.order.surround_face) continue;
    if (std::ranges::any_of(client.held, [&](const HeldPicture& h) { return h.id == held.id; }))
      continue;
    if (held.face >= 0) {
      const double due = due_distance(held.typical_inverse_z, cell, choice.need.frame);
      const bool close = glm::length(held.camera.position() - choice.order.camera.position()) < due;
      if (close && held.camera.width == choice.order.camera.width) return held.id;
      continue;
    }
    if (held.fine != choice.order.fine) continue;
    // As sharp as one made for it.
    const double sharp = frame_scale(held.camera).pixels_per_tangent /
                         frame_scale(choice.order.camera).pixels_per_tangent;
    if (sharp < 0.85 || sharp > 1.5 || !shows(held, choice.target, cell, kShareWithin)) continue;
    // Would it be enough?
    std::vector<HeldPicture> with = client.held;
    with.push_back(held);
    const ViewNeed then = view_need(with, arrival, choice.need.frame, cell, false, choice.lead);
    const bool coarse = choice.need.wanted == Wanted::coarse_view;
    if (then.score < 1 || then.wanted == Wanted::surround ||
        (coarse && then.wanted != Wanted::coarse_view))
      return held.id;
  }
  return 0;
}

// Requires the mutex.
std::optional<Choice> LiveWorld::State::choose(double now) const {
  std::optional<Choice> best;
  double most = 0;
  int queue = 0;
  for (const std::shared_ptr<Client>& client : clients) {
    if (!client->pose || now < client->blocked_until) continue;
    LiveHello hello = client->hello;
    if (hello.height > options.most_lines) {
      hello.width = std::max(1, hello.width * options.most_lines / hello.height);
      hello.height = options.most_lines;
    }
    // The pose is as old as its way took, and a picture arrives after as long a way.
    const double lead =
        now - client->pose_at + 2e-3 * client->pose->latency_ms + client->wait_s + view_s;
    const LivePose arrival = client->history.forecast(lead, lead).pose;
    const Camera frame = camera_of(arrival, hello, scene.start.z_near, scene.start.z_far);
    std::vector<HeldPicture> held = client->held;
    if (client->waiting)
      held.push_back(held_of(*client->waiting->picture, client->waiting->head.id));
    const double cell = arrival.cell > 0 ? arrival.cell : options.cell;
    const bool stands = glm::length(arrival.velocity) == 0 && glm::length(arrival.turn_rate) == 0;
    ViewNeed need = view_need(held, arrival, frame, cell, stands, lead);
    // Whose turn comes late has always moved on: another coarse one would be the next one, too.
    if (need.wanted == Wanted::coarse_view && client->coarse_last) need.wanted = Wanted::fine_view;
    queue += need.score >= 1;
    // A surround does not replace a view that waits, and nothing one that has just been made.
    if (need.score == 0) continue;
    if (client->waiting && (need.score < 1 || need.wanted == Wanted::surround ||
                            now < client->waiting->ready_at + kFresh))
      continue;
    // The worst view first, and the longer it has been so the more: nobody waits for ever.
    const double urgency = need.score * (kLeastAge + now - client->served_at);
    if (best && urgency <= most) continue;
    most = urgency;
    best = Choice{client, need, {}, frame, client->pose->sequence, 0, lead};
  }
  if (!best) return best;
  const LivePose arrival = best->client->history.forecast(best->lead, best->lead).pose;
  best->order = order_for(*best->client, arrival, best->need, best->lead, queue, best->target);
  best->kept = find_kept(*best->client, *best, arrival);
  return best;
}

// Requires the mutex.
void LiveWorld::State::keep(std::uint64_t id, const std::shared_ptr<const MadePicture>& picture) {
  const auto bytes = [](const MadePicture& one) {
    return one.bytes() + 4 * one.objects.texels().size();
  };
  stats.kept_bytes += bytes(*picture);
  kept.emplace(id, picture);
  while (stats.kept_bytes > options.kept_bytes && kept.size() > 1) {
    stats.kept_bytes -= bytes(*kept.begin()->second);
    kept.erase(kept.begin());
  }
}

// Requires the mutex.
void LiveWorld::State::deliver(const Choice& choice, std::shared_ptr<const MadePicture> picture,
                               std::uint64_t id, double now, double ready_at) {
  Client& client = *choice.client;
  if (client.gone) return;
  if (client.waiting) ++stats.replaced;
  Waiting waiting{std::move(picture), {}, ready_at};
  waiting.head = waiting.picture->head;
  waiting.head.id = id;
  // A surround's faces share the keyframe of the first.
  waiting.head.keyframe = id;
  if (choice.order.surround_face >= 0) {
    const glm::dvec3 eye = waiting.picture->camera.position();
    if (client.surround_id == 0 || eye != client.surround_eye)
      client.surround_id = id, client.surround_eye = eye;
    waiting.head.keyframe = client.surround_id;
  } else {
    client.coarse_last = !waiting.head.fine;
  }
  client.served_at = now;
  waiting.head.sequence = choice.sequence;
  waiting.head.server_ms = 1e3 * now;
  client.waiting = std::move(waiting);
}

// Makes one picture, or takes a kept one. Returns its seconds, 0 if nothing is needed.
double LiveWorld::State::step(double now, bool timed) {
  std::optional<Choice> choice;
  {
    const std::lock_guard lock(mutex);
    choice = stopping ? std::nullopt : choose(now);
    if (!choice) {
      running = false;
      return 0;
    }
    if (choice->kept != 0) {
      ++stats.shared;
      deliver(*choice, kept.at(choice->kept), choice->kept, now, now);
      return 1e-6;
    }
  }
  const BusyWatch watch;
  const bool coarse = !choice->order.fine;
  Result<MadePicture> made = make_live_picture(coarse ? quick : source, choice->order);
  const double busy = 1e-3 * watch.ms();
  const double fixed = coarse && options.coarse_work_s > 0 ? options.coarse_work_s : options.work_s;
  // Wide pictures take longer.
  const double usual =
      options.margin * options.margin * choice->target.width * choice->target.height;
  const double texels = double(choice->order.camera.width) * choice->order.camera.height;
  const double share = coarse ? 1 : std::max(1.0, texels / usual);
  const double took = fixed > 0 ? fixed * share : std::max(busy / kCores, 1e-6);
  const std::lock_guard lock(mutex);
  stats.busy_s += busy;
  if (!made) {
    ++stats.failed;
    choice->client->blocked_until = now + kAfterFailure;
    return took;
  }
  ++stats.made;
  stats.coarse += coarse && choice->order.surround_face < 0;
  stats.surround += choice->order.surround_face >= 0;
  if (!coarse) view_s += kNewest * (took - view_s);
  if (!options.keep_objects) made->objects = {};
  const auto picture = std::make_shared<const MadePicture>(std::move(*made));
  const std::uint64_t id = next_id++;
  keep(id, picture);
  deliver(*choice, picture, id, now, timed ? now + took : now);
  return took;
}

LiveWorld::LiveWorld(CaptureSource& source, CaptureSource& quick, const LiveScene& scene,
                     const LiveWorldOptions& options)
    : state_(std::make_shared<State>(source, quick, scene, options)) {
  RILIEVO_EXPECTS(options.margin >= 1 && options.error_px > 0 && options.cell >= 0);
}

LiveWorld::~LiveWorld() {
  {
    const std::lock_guard lock(state_->mutex);
    state_->stopping = true;
  }
  state_->stop.request_stop();
  state_->background.reset();
}

std::unique_ptr<LiveSession> LiveWorld::connect() {
  auto client = std::make_shared<Client>();
  LiveWelcome welcome;
  const LiveScene& scene = state_->scene;
  welcome.name = scene.name.substr(0, 255);
  welcome.bounds = scene.bounds;
  if (welcome.bounds.empty()) welcome.bounds = {glm::vec3(-1), glm::vec3(1)};
  welcome.up = scene.up;
  welcome.eye = scene.start.position();
  welcome.target = welcome.eye + scene.start.forward() *
                                     std::max(double(welcome.bounds.radius()), scene.start.z_near);
  welcome.vertical_fov = std::atan(scene.start.window.top) - std::atan(scene.start.window.bottom);
  welcome.z_near = scene.start.z_near, welcome.z_far = scene.start.z_far;
  welcome.unit = scene.metres_per_unit;
  client->control.push_back(message_of(welcome));
  const std::lock_guard lock(state_->mutex);
  state_->clients.push_back(client);
  state_->stats.clients = int(state_->clients.size());
  return std::make_unique<WorldSession>(state_, client);
}

void LiveWorld::start(std::function<double()> clock, std::function<void()> ready) {
  const std::lock_guard lock(state_->mutex);
  state_->clock = std::move(clock);
  state_->ready = std::move(ready);
  state_->background.emplace();
  state_->kick();
}

double LiveWorld::work(double now) { return state_->step(now, true); }

LiveWorldStats LiveWorld::stats() const {
  const std::lock_guard lock(state_->mutex);
  return state_->stats;
}

std::shared_ptr<const MadePicture> LiveWorld::picture(std::uint64_t id) const {
  const std::lock_guard lock(state_->mutex);
  const auto found = state_->kept.find(id);
  return found == state_->kept.end() ? nullptr : found->second;
}

}  // namespace rilievo
