#pragma once

#include <opencv2/core.hpp>
#include <string>

#include "engine/inspect/screen.h"

namespace planecast::app {

/// Shows the inspector in a window until it is closed. The pictures are drawn by our own renderer
/// and put into the window as they are, so that no OpenGL of the display is needed. Throws
/// UserError where there is no display.
void show_window(engine::InspectWindow& window, engine::InspectScreen& screen, cv::Size size,
                 const std::string& title);

}  // namespace planecast::app
