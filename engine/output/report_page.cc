#include "engine/output/report_page.h"

#include <system_error>

#include "engine/assets.h"
#include "engine/output/atomic_file.h"
#include "engine/program.h"

namespace planecast::engine {
namespace {

namespace fs = std::filesystem;

constexpr const char* kMapView = "report/map_view.bundle.js";

/// Built beside the executable, or installed with the assets.
std::string read_map_view() {
  std::error_code ignored;
  for (const fs::path& folder : {executable_folder(), assets_dir()}) {
    if (fs::is_regular_file(folder / kMapView, ignored)) return read_file(folder / kMapView);
  }
  return "";
}

}  // namespace

PageFiles read_page_files() {
  return {read_file(asset("report/style.css")), read_file(asset("report/page.js")),
          read_map_view()};
}

std::string script_text(const std::string& code) {
  std::string safe;
  std::size_t from = 0;
  for (std::size_t at = code.find("</"); at != std::string::npos; at = code.find("</", from)) {
    safe += code.substr(from, at - from) + "<\\/";
    from = at + 2;
  }
  return safe + code.substr(from);
}

}  // namespace planecast::engine
