// The pictures of a bake as independent pieces, which any machine can make in any order.
//
// A bake asks for its pictures one after the other, but for none because of another. A recorder in
// place of the source of light notes what is asked for, and answers with something quick. Each
// piece is then captured through a KeptSource over a folder (picture_folder.h); the bake itself
// finds them there.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "rilievo/capture/forwarding_source.h"
#include "rilievo/capture/store/kept_source.h"

namespace rilievo {

// One picture, or the layers of one.
struct CapturePiece {
  Camera camera;
  std::vector<std::uint32_t> objects;
  int samples = 1;
  bool identifiers = true, with_sky = false;
  bool layers = false;
  double merge = 0;      // of layers
  int max_layers = 256;  // of layers
};

// The keys under which a piece is kept: one, or two of layers.
[[nodiscard]] std::vector<PictureKey> keys_of(const CapturePiece& piece,
                                              const KeptOptions& options);
// Captures a piece, and leaves it to the source to keep it.
[[nodiscard]] Result<> capture_piece(const CapturePiece& piece, CaptureSource& source);

// Notes what is asked of a source.
class PieceRecorder final : public ForwardingSource {
 public:
  // `source`: what is asked, as far as names and bounds go. `quick` answers with pictures of the
  // same surfaces; null: the pictures are empty. Both must outlive it.
  PieceRecorder(CaptureSource& source, CaptureSource* quick)
      : ForwardingSource(source), quick_(quick) {}

  [[nodiscard]] Result<CapturedPicture> capture(const CaptureRequest& request) override;
  [[nodiscard]] Result<LayeredDepthImage> capture_layers(const LayersRequest& request) override;

  // In the order in which they were asked for.
  [[nodiscard]] const std::vector<CapturePiece>& pieces() const { return pieces_; }

 private:
  CaptureSource* quick_;
  std::vector<CapturePiece> pieces_;
};

// A piece as JSON, on one line, and back: the very same one. The error says what is wrong.
[[nodiscard]] std::string piece_json(const CapturePiece& piece);
[[nodiscard]] Result<CapturePiece> piece_from_json(const std::string& text);

}  // namespace rilievo
