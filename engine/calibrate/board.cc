#include "engine/calibrate/board.h"

#include <fmt/format.h>

#include <opencv2/aruco/charuco.hpp>
#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>
#include <set>

#include "engine/channels.h"
#include "engine/marker_dictionary.h"
#include "engine/user_error.h"

namespace planecast::engine {
namespace {

constexpr int kLeastCorners = 8;
constexpr int kMostSquares = 50;

cv::Ptr<cv::aruco::Dictionary> dictionary_named(const std::string& name) {
  if (const auto dictionary = marker_dictionary(name)) return dictionary;
  throw UserError(fmt::format("{}: no such dictionary of markers ({})", name,
                              fmt::join(marker_dictionary_names(), ", ")));
}

/// Corners of one row or column alone say nothing of the plane.
bool spans_plane(const std::vector<cv::Point3f>& board) {
  std::set<float> columns;
  std::set<float> rows;
  for (const cv::Point3f& corner : board) {
    columns.insert(corner.x);
    rows.insert(corner.y);
  }
  return static_cast<int>(board.size()) >= kLeastCorners && columns.size() > 1 && rows.size() > 1;
}

}  // namespace

struct BoardDetector::Charuco {
  cv::Ptr<cv::aruco::Dictionary> dictionary;
  cv::Ptr<cv::aruco::CharucoBoard> board;
};

BoardDetector::BoardDetector(const BoardSpec& spec) : spec_(spec) {
  if (spec.columns < 4 || spec.rows < 4 || spec.columns > kMostSquares ||
      spec.rows > kMostSquares) {
    throw UserError(fmt::format("a board of {}x{} squares: each side must have 4 to {}",
                                spec.columns, spec.rows, kMostSquares));
  }
  if (spec.kind == BoardKind::kChessboard) return;
  if (spec.marker_share <= 0.0 || spec.marker_share >= 1.0) {
    throw UserError("the markers' share of the squares' side must be between 0 and 1");
  }
  charuco_ = std::make_unique<Charuco>();
  charuco_->dictionary = dictionary_named(spec.dictionary);
  const int markers = spec.columns * spec.rows / 2;
  const int known = charuco_->dictionary->bytesList.rows;
  if (markers > known) {
    throw UserError(fmt::format("a board of {}x{} squares has {} markers, the dictionary {} {}",
                                spec.columns, spec.rows, markers, spec.dictionary, known));
  }
  charuco_->board = cv::aruco::CharucoBoard::create(
      spec.columns, spec.rows, 1.0F, static_cast<float>(spec.marker_share), charuco_->dictionary);
}

BoardDetector::~BoardDetector() = default;

std::optional<BoardView> BoardDetector::find(const cv::Mat& image) const {
  const cv::Mat grey = to_grey(image);
  return charuco_ ? find_charuco(grey) : find_chessboard(grey);
}

std::optional<BoardView> BoardDetector::find_chessboard(const cv::Mat& grey) const {
  const cv::Size inner(spec_.columns - 1, spec_.rows - 1);
  // Most pictures without a board are told quickly.
  if (!cv::checkChessboard(grey, inner)) return std::nullopt;
  BoardView view;
  if (!cv::findChessboardCornersSB(grey, inner, view.image, cv::CALIB_CB_NORMALIZE_IMAGE)) {
    return std::nullopt;
  }
  for (int row = 0; row < inner.height; ++row) {
    for (int col = 0; col < inner.width; ++col) {
      view.board.emplace_back(static_cast<float>(col + 1), static_cast<float>(row + 1), 0.0F);
    }
  }
  return view;
}

std::optional<BoardView> BoardDetector::find_charuco(const cv::Mat& grey) const {
  std::vector<std::vector<cv::Point2f>> markers;
  std::vector<int> ids;
  cv::aruco::detectMarkers(grey, charuco_->dictionary, markers, ids);
  if (ids.empty()) return std::nullopt;
  BoardView view;
  std::vector<int> corner_ids;
  cv::aruco::interpolateCornersCharuco(markers, ids, grey, charuco_->board, view.image, corner_ids);
  for (const int id : corner_ids) {
    view.board.push_back(charuco_->board->chessboardCorners[static_cast<std::size_t>(id)]);
  }
  if (!spans_plane(view.board)) return std::nullopt;
  return view;
}

cv::Mat BoardDetector::draw(int square_px) const {
  const cv::Size size(spec_.columns * square_px, spec_.rows * square_px);
  cv::Mat board;
  if (charuco_) {
    charuco_->board->draw(size, board);
  } else {
    board = cv::Mat(size, CV_8UC1, cv::Scalar(255));
    for (int row = 0; row < spec_.rows; ++row) {
      for (int col = row % 2; col < spec_.columns; col += 2) {
        board(cv::Rect(col * square_px, row * square_px, square_px, square_px)) = 0;
      }
    }
  }
  cv::Mat page;
  const int margin = square_px / 2;
  cv::copyMakeBorder(board, page, margin, margin, margin, margin, cv::BORDER_CONSTANT,
                     cv::Scalar(255));
  return page;
}

}  // namespace planecast::engine
