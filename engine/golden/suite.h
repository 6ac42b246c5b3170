#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "engine/sequence/synth.h"

namespace planecast::engine {

/// How far a picture may be from the expected one. All three must hold.
struct GoldenTolerance {
  int channel = 5;       ///< of 255: a pixel with a channel beyond it counts as different
  double share = 0.001;  ///< of the pixels that may be different
  double ssim = 0.98;    ///< least structural similarity
};

/// A sequence, a scene over it, and the frames to look at.
struct GoldenCase {
  std::string name;                      ///< a folder's name
  std::filesystem::path sequence;        ///< on disk; empty: synth
  std::optional<SynthOptions> synth;     ///< made on the fly
  std::filesystem::path reconstruction;  ///< empty: the sequence is tracked
  std::filesystem::path scene;           ///< empty: the built-in content
  std::string camera;                    ///< preset or file; empty: as the sequence says
  std::string size;                      ///< WxH; empty: as recorded
  std::string range;                     ///< A:B, the part that is tracked; empty: all
  std::string mode = "auto";
  std::string segmentation = "auto";
  bool causal = false;
  std::uint64_t seed = 1;
  std::vector<int> frames;  ///< of the whole sequence, ascending
  GoldenTolerance tolerance;
};

/// The cases of DIR/golden.yaml; expected pictures are DIR/expected/CASE/NNNNNN.png.
struct GoldenSuite {
  std::filesystem::path folder;
  std::vector<GoldenCase> cases;

  std::filesystem::path expected_folder() const { return folder / "expected"; }
};

/// File of a case's frame below the folder of expected or actual pictures: "robot/000120.png".
std::filesystem::path golden_picture(const GoldenCase& golden_case, int frame);

/// Reads DIR/golden.yaml. Relative paths in it are looked up beside it. Throws UserError
/// "file:LINE: reason" for anything it does not know.
GoldenSuite read_golden_suite(const std::filesystem::path& folder);

/// Writes a golden.yaml that works as it is, and a .gitignore for the results. Throws UserError
/// where one is there already.
void init_golden_suite(const std::filesystem::path& folder);

}  // namespace planecast::engine
