#pragma once

#include <filesystem>
#include <optional>
#include <string>

namespace planecast::engine {

/// What makes a page of the report's parts: assets/report/, and the 3D view where it was built.
struct PageFiles {
  std::string style;
  std::string script;
  std::string map_view;  ///< empty: not built, the drawing of the map stays
};

/// Throws UserError when the assets are not there.
PageFiles read_page_files();

/// JavaScript as the content of a <script> element: nothing in it can end the element.
std::string script_text(const std::string& code);

}  // namespace planecast::engine
