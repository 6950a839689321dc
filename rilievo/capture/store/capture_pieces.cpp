#include "rilievo/capture/store/capture_pieces.h"

#include <nlohmann/json.hpp>
#include <utility>

namespace rilievo {
namespace {

using PieceJson = nlohmann::json;

CaptureRequest picture_of(const CapturePiece& piece) {
  CaptureRequest request;
  request.camera = piece.camera;
  request.objects = piece.objects;
  request.samples = piece.samples;
  request.identifiers = piece.identifiers;
  request.with_sky = piece.with_sky;
  return request;
}

LayersRequest layers_of(const CapturePiece& piece) {
  LayersRequest request;
  request.camera = piece.camera;
  request.objects = piece.objects;
  request.samples = piece.samples;
  request.merge = piece.merge;
  request.max_layers = piece.max_layers;
  return request;
}

PieceJson json_of_camera(const Camera& camera) {
  PieceJson pose = PieceJson::array();
  for (int column = 0; column < 4; ++column)
    for (int row = 0; row < 4; ++row) pose.push_back(camera.world_from_eye[column][row]);
  const ImageWindow& w = camera.window;
  return {{"projection", int(camera.projection)},
          {"size", {camera.width, camera.height}},
          {"window", {w.left, w.right, w.bottom, w.top}},
          {"depth_range", {camera.z_near, camera.z_far}},
          {"world_from_eye", pose}};
}

// Throws what nlohmann throws.
Camera camera_of(const PieceJson& json) {
  Camera camera;
  camera.projection = Projection(json.at("projection").get<int>());
  json.at("size").at(0).get_to(camera.width);
  json.at("size").at(1).get_to(camera.height);
  ImageWindow& w = camera.window;
  int i = 0;
  for (double* number : {&w.left, &w.right, &w.bottom, &w.top})
    json.at("window").at(std::size_t(i++)).get_to(*number);
  json.at("depth_range").at(0).get_to(camera.z_near);
  json.at("depth_range").at(1).get_to(camera.z_far);
  for (int k = 0; k < 16; ++k)
    json.at("world_from_eye").at(std::size_t(k)).get_to(camera.world_from_eye[k / 4][k % 4]);
  return camera;
}

}  // namespace

std::vector<PictureKey> keys_of(const CapturePiece& piece, const KeptOptions& options) {
  if (!piece.layers) return {kept_key(picture_of(piece), {}, options)};
  LayersKeys keys = kept_keys(layers_of(piece), options);
  return {keys.samples, keys.counts};
}

Result<> capture_piece(const CapturePiece& piece, CaptureSource& source) {
  if (piece.layers) {
    const Result<LayeredDepthImage> layers = source.capture_layers(layers_of(piece));
    if (!layers) return layers.error();
    return Done{};
  }
  const Result<CapturedPicture> captured = source.capture(picture_of(piece));
  if (!captured) return captured.error();
  return Done{};
}

Result<CapturedPicture> PieceRecorder::capture(const CaptureRequest& request) {
  CapturePiece piece;
  piece.camera = request.camera;
  piece.objects.assign(request.objects.begin(), request.objects.end());
  piece.samples = request.samples;
  piece.identifiers = request.identifiers, piece.with_sky = request.with_sky;
  pieces_.push_back(piece);
  CaptureRequest quick = request;
  quick.samples = 1;
  quick.with_sky = false;
  if (quick_) return quick_->capture(quick);
  const Camera& camera = request.camera;
  CapturedPicture empty;
  empty.picture.camera = camera;
  empty.picture.color = ColorImage(camera.width, camera.height);
  empty.picture.depth = Image<float>(camera.width, camera.height, kNoDepth);
  return empty;
}

Result<LayeredDepthImage> PieceRecorder::capture_layers(const LayersRequest& request) {
  CapturePiece piece;
  piece.layers = true;
  piece.camera = request.camera;
  piece.objects.assign(request.objects.begin(), request.objects.end());
  piece.samples = request.samples;
  piece.merge = request.merge, piece.max_layers = request.max_layers;
  pieces_.push_back(piece);
  if (!quick_) return source_.capture_layers(request);
  LayersRequest quick = request;
  quick.samples = 1;
  return quick_->capture_layers(quick);
}

std::string piece_json(const CapturePiece& piece) {
  PieceJson json{{"camera", json_of_camera(piece.camera)}, {"samples", piece.samples}};
  if (!piece.objects.empty()) json["objects"] = piece.objects;
  if (piece.layers) {
    json["layers"] = {{"merge", piece.merge}, {"most", piece.max_layers}};
  } else {
    json["identifiers"] = piece.identifiers;
    json["sky"] = piece.with_sky;
  }
  return json.dump();
}

Result<CapturePiece> piece_from_json(const std::string& text) {
  CapturePiece piece;
  try {
    const PieceJson json = PieceJson::parse(text);
    piece.camera = camera_of(json.at("camera"));
    json.at("samples").get_to(piece.samples);
    if (json.contains("objects")) json["objects"].get_to(piece.objects);
    piece.layers = json.contains("layers");
    if (piece.layers) {
      json["layers"].at("merge").get_to(piece.merge);
      json["layers"].at("most").get_to(piece.max_layers);
    } else {
      json.at("identifiers").get_to(piece.identifiers);
      json.at("sky").get_to(piece.with_sky);
    }
  } catch (const PieceJson::exception& wrong) {
    return Error{"piece", wrong.what()};
  }
  const int projection = int(piece.camera.projection);
  if (projection < 0 || projection > 2) return Error{"piece", "has no such projection"};
  if (Result<> valid = validate(piece.camera); !valid) return valid.error();
  return piece;
}

}  // namespace rilievo
