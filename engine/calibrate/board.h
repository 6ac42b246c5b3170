#pragma once

#include <memory>
#include <opencv2/core.hpp>
#include <optional>
#include <string>
#include <vector>

namespace planecast::engine {

enum class BoardKind {
  kChessboard,  ///< must be seen whole
  kCharuco,     ///< markers in the white squares: may be seen in part
};

/// A flat board of black and white squares. One square is the unit of length: intrinsics do not
/// depend on its real size.
struct BoardSpec {
  BoardKind kind = BoardKind::kChessboard;
  int columns = 10;                   ///< squares, not inner corners
  int rows = 7;                       ///< squares
  double marker_share = 0.75;         ///< side of a marker, of a square's (ChArUco)
  std::string dictionary = "4x4_50";  ///< one of marker_dictionary_names() (ChArUco)
};

/// Inner corners of the board that were seen in a picture, pair by pair.
struct BoardView {
  std::vector<cv::Point3f> board;  ///< squares; z = 0
  std::vector<cv::Point2f> image;  ///< raw pixels
};

/// Finds one board in pictures.
class BoardDetector {
 public:
  /// Throws UserError for an impossible board (too small, more markers than the dictionary has).
  explicit BoardDetector(const BoardSpec& spec);
  ~BoardDetector();
  BoardDetector(const BoardDetector&) = delete;
  BoardDetector& operator=(const BoardDetector&) = delete;

  /// 8-bit grey or BGR. Nothing where the board is not seen: whole for a chessboard, by at least 8
  /// corners in more than one row and column for ChArUco.
  std::optional<BoardView> find(const cv::Mat& image) const;

  /// The board for printing, with a white margin of half a square; 8-bit grey.
  cv::Mat draw(int square_px) const;

 private:
  struct Charuco;

  std::optional<BoardView> find_chessboard(const cv::Mat& grey) const;
  std::optional<BoardView> find_charuco(const cv::Mat& grey) const;

  BoardSpec spec_;
  std::unique_ptr<Charuco> charuco_;  ///< null for a chessboard
};

}  // namespace planecast::engine
