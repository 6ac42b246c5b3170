#pragma once

#include <opencv2/aruco.hpp>
#include <string>
#include <vector>

namespace planecast::engine {

/// Names of OpenCV's dictionaries of printed markers, as options and scene files give them:
/// "4x4_50" ... "7x7_1000", "original", "apriltag_16h5" ... "apriltag_36h11".
std::vector<std::string> marker_dictionary_names();

/// Null where there is no dictionary of that name.
cv::Ptr<cv::aruco::Dictionary> marker_dictionary(const std::string& name);

}  // namespace planecast::engine
