// What a capture's JSON says of its lenses, in the words of nerfstudio, instant-ngp and COLMAP.
#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <nlohmann/json.hpp>

#include "rilievo/io/rgbd_open.h"
#include "rilievo/io/text_scan.h"

namespace rilievo::rgbd {
namespace {

using Json = nlohmann::json;
using Objects = std::initializer_list<const Json*>;
using Model = LensDistortion::Model;

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

const Json* find(Objects objects, const char* name) {
  for (const Json* object : objects)
    if (const auto found = object->find(name); found != object->end() && !found->is_null())
      return &*found;
  return nullptr;
}

// Throws what is no number.
double number(Objects objects, const char* name, double otherwise) {
  const Json* found = find(objects, name);
  if (!found) return otherwise;
  if (found->is_number() && std::isfinite(found->get<double>())) return found->get<double>();
  refuse(std::string("\"") + name + "\" is not a finite number");
}

int texels(Objects objects, const char* name) {
  const double value = number(objects, name, 0);
  if (value >= 0 && value <= (1 << 16) && value == std::floor(value)) return int(value);
  refuse(std::string("\"") + name + "\" is no size of an image");
}

bool is_true(Objects objects, const char* name) {
  const Json* found = find(objects, name);
  return found && ((found->is_boolean() && found->get<bool>()) ||
                   (found->is_number() && found->get<double>() != 0) ||
                   (found->is_string() && lower_case(found->get<std::string>()) == "true"));
}

// The focal length of one axis, or the angle that stands for it, whichever a frame or the file
// says first.
void read_focal(Objects objects, const char* length_name, const char* angle_name, double& length,
                double& angle) {
  for (const Json* object : objects) {
    if (find({object}, length_name)) {
      length = number({object}, length_name, kNone);
      return;
    }
    if (find({object}, angle_name)) {
      angle = number({object}, angle_name, 0);
      return;
    }
  }
}

struct Words {
  Model model = Model::series;
  bool rational = false;  // k4 to k6 divide
};

// What the model's name says; lenses of other kinds are refused by name.
Words model_of(Objects objects) {
  Words words;
  if (is_true(objects, "is_fisheye") || is_true(objects, "fisheye")) words.model = Model::fisheye;
  for (const char* other : {"ftheta_p0", "ftheta_p1", "latlong", "equirectangular", "spherical"})
    if (find(objects, other) && (other[0] == 'f' || is_true(objects, other)))
      refuse(std::string("the lens is given by \"") + other +
             "\", which is not supported: undistort the images first");
  for (const char* member : {"camera_model", "camera_type", "model"}) {
    const Json* found = find(objects, member);
    if (!found) continue;
    const std::string name = found->is_string() ? lower_case(found->get<std::string>()) : "";
    if (name == "opencv_fisheye" || name == "fisheye" || name == "radial_fisheye" ||
        name == "simple_radial_fisheye" || name == "equidistant") {
      words.model = Model::fisheye;
    } else if (name == "full_opencv") {
      words.rational = true;
    } else if (name != "opencv" && name != "pinhole" && name != "simple_pinhole" &&
               name != "perspective" && name != "radial" && name != "simple_radial") {
      refuse(std::string("\"") + member + "\" is " + found->dump().substr(0, 40) +
             ", none of PINHOLE, SIMPLE_PINHOLE, SIMPLE_RADIAL, RADIAL, OPENCV, FULL_OPENCV, "
             "OPENCV_FISHEYE: undistort the images first");
    }
  }
  return words;
}

// A list in nerfstudio's order, k1 k2 k3 k4 p1 p2, or in OpenCV's, k1 k2 p1 p2 [k3 [k4 k5 k6]].
void read_list(const Json& list, const char* name, bool fisheye, LensDistortion& lens) {
  std::vector<double> v;
  for (const Json& each : list.is_array() ? list : Json::array({nullptr})) {
    if (!each.is_number() || !std::isfinite(each.get<double>()))
      refuse(std::string("\"") + name + "\" is no list of finite numbers");
    v.push_back(each.get<double>());
  }
  if (std::all_of(v.begin(), v.end(), [](double c) { return c == 0; })) return;
  const std::size_t n = v.size();
  if (n == 6 || (fisheye && n <= 4)) {
    for (std::size_t i = 0; i < std::min<std::size_t>(n, 4); ++i) lens.k[i] = v[i];
    if (n == 6) lens.p = {v[4], v[5]};
  } else if (!fisheye && (n == 4 || n == 5 || n == 8)) {
    lens.k[0] = v[0], lens.k[1] = v[1];
    lens.p = {v[2], v[3]};
    for (std::size_t i = 4; i < n; ++i) lens.k[i - 2] = v[i];
    if (n == 8) lens.model = Model::radial;
  } else if (!fisheye && n <= 2) {
    for (std::size_t i = 0; i < n; ++i) lens.k[i] = v[i];
  } else {
    refuse(std::string("\"") + name + "\" has " + std::to_string(n) +
           " numbers, which is no known order: undistort the images first");
  }
}

LensDistortion distortion_of(Objects objects) {
  const Words words = model_of(objects);
  LensDistortion lens{words.model};
  // What a frame says itself comes last, and counts.
  const std::vector<const Json*> order(std::reverse_iterator(objects.end()),
                                       std::reverse_iterator(objects.begin()));
  for (const Json* object : order) {
    for (const char* name :
         {"distortion_params", "distortion", "dist_coeffs", "distortion_coefficients"})
      if (const Json* list = find({object}, name); list && list->is_array()) {
        lens = LensDistortion{words.model};
        read_list(*list, name, words.model == Model::fisheye, lens);
      }
    constexpr const char* kNames[] = {"k1", "k2", "k3", "k4", "k5", "k6"};
    lens.k[0] = number({object}, "k", lens.k[0]);
    for (std::size_t i = 0; i < 6; ++i) lens.k[i] = number({object}, kNames[i], lens.k[i]);
    lens.p = {number({object}, "p1", lens.p[0]), number({object}, "p2", lens.p[1])};
  }
  for (const char* other : {"s1", "s2", "s3", "s4", "omega", "sx1", "sy1"})
    if (number(objects, other, 0) != 0)
      refuse(std::string("the lens is distorted by \"") + other +
             "\", which is not supported: undistort the images first");
  if (lens.model == Model::fisheye) {
    for (const auto& [name, value] :
         {std::pair("k5", lens.k[4]), {"k6", lens.k[5]}, {"p1", lens.p[0]}, {"p2", lens.p[1]}})
      if (value != 0)
        refuse(std::string("the lens is a fisheye with \"") + name +
               "\", which is not supported: undistort the images first");
    return lens;
  }
  if (words.rational || lens.k[4] != 0 || lens.k[5] != 0) lens.model = Model::radial;
  const auto is_zero = [](double c) { return c == 0; };
  if (std::all_of(lens.k.begin(), lens.k.end(), is_zero) &&
      std::all_of(lens.p.begin(), lens.p.end(), is_zero))
    lens.model = Model::none;
  return lens;
}

}  // namespace

std::string read_distortion(Objects objects, LensDistortion& distortion) {
  try {
    distortion = distortion_of(objects);
    return {};
  } catch (const LoadError& fault) {
    return fault.reason;
  }
}

std::string read_lens(Objects objects, RgbdIntrinsics& lens) {
  try {
    lens = {kNone, kNone, kNone, kNone};
    read_focal(objects, "fl_x", "camera_angle_x", lens.fl_x, lens.angle_x);
    read_focal(objects, "fl_y", "camera_angle_y", lens.fl_y, lens.angle_y);
    const auto unknown = [](double length, double angle) {
      return std::isnan(length) && angle == 0;
    };
    if (unknown(lens.fl_x, lens.angle_x) && unknown(lens.fl_y, lens.angle_y))
      return "there is neither \"fl_x\" nor \"camera_angle_x\"";
    lens.cx = number(objects, "cx", kNone);
    lens.cy = number(objects, "cy", kNone);
    lens.width = texels(objects, "w");
    lens.height = texels(objects, "h");
    lens.distortion = distortion_of(objects);
  } catch (const LoadError& fault) {
    return fault.reason;
  }
  const Result<> fine = check(lens);
  return fine ? std::string() : fine.error().reason;
}

}  // namespace rilievo::rgbd
