#include <gtest/gtest.h>

#include <filesystem>

#include "engine/golden/report.h"
#include "engine/golden/suite.h"
#include "engine/golden/swap_folder.h"
#include "engine/output/atomic_file.h"

namespace planecast::engine {
namespace {

namespace fs = std::filesystem;

fs::path empty_folder(const std::string& name) {
  fs::path folder = testing::TempDir() + "golden_" + name;
  fs::remove_all(folder);
  fs::create_directories(folder);
  return folder;
}

std::vector<GoldenResult> results() {
  const cv::Mat white(20, 30, CV_8UC3, cv::Scalar::all(255));
  const cv::Mat grey(20, 30, CV_8UC3, cv::Scalar::all(250));
  return {
      {"a", 3, GoldenStatus::kSame, "fine", compare_images(white, white), white, white},
      {"a", 4, GoldenStatus::kDiffers, "off by \"5\"", compare_images(white, grey), white, grey},
      {"a", 5, GoldenStatus::kMissing, "missing", {}, {}, white},
      {"b", -1, GoldenStatus::kFailed, "</script> & no such file", {}, {}, {}}};
}

TEST(GoldenReport, JunitCountsEachSuite) {
  const fs::path file = empty_folder("junit") / "golden.xml";
  write_junit(results(), file);
  EXPECT_EQ(read_file(file),
            "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n"
            "<testsuites name=\"planecast golden\" tests=\"4\" failures=\"2\" errors=\"1\">\n"
            "  <testsuite name=\"a\" tests=\"3\" failures=\"2\" errors=\"0\">\n"
            "    <testcase classname=\"a\" name=\"frame 3\"/>\n"
            "    <testcase classname=\"a\" name=\"frame 4\">\n"
            "      <failure message=\"off by &quot;5&quot;\"/>\n"
            "    </testcase>\n"
            "    <testcase classname=\"a\" name=\"frame 5\">\n"
            "      <failure message=\"missing\"/>\n"
            "    </testcase>\n"
            "  </testsuite>\n"
            "  <testsuite name=\"b\" tests=\"1\" failures=\"0\" errors=\"1\">\n"
            "    <testcase classname=\"b\" name=\"draw\">\n"
            "      <error message=\"&lt;/script&gt; &amp; no such file\"/>\n"
            "    </testcase>\n"
            "  </testsuite>\n"
            "</testsuites>\n");
}

TEST(GoldenReport, NoMessageEndsTheScript) {
  const fs::path file = empty_folder("report") / "report.html";
  write_golden_report(results(), "A <title>", file);
  const std::string page = read_file(file);
  EXPECT_EQ(page.find("{{"), std::string::npos);
  EXPECT_NE(page.find("<h1>A &lt;title&gt;</h1>"), std::string::npos);
  EXPECT_NE(page.find("<\\/script> & no such file"), std::string::npos);
  EXPECT_EQ(page.find("</script> &"), std::string::npos);
}

TEST(GoldenUpdate, ReplacesAFolderWhole) {
  const fs::path folder = empty_folder("swap");
  for (const char* name : {"old", "new"}) {
    fs::create_directories(folder / name / name);
    write_file(folder / name / "file.txt", name);
  }
  replace_folder(folder / "new", folder / "old");
  EXPECT_EQ(read_file(folder / "old" / "file.txt"), "new");
  EXPECT_FALSE(fs::exists(folder / "old" / "old"));
  EXPECT_FALSE(fs::exists(folder / "new"));
  fs::rename(folder / "old", folder / "new");
  replace_folder(folder / "new", folder / "old");  // where there was none
  EXPECT_EQ(read_file(folder / "old" / "file.txt"), "new");
}

TEST(GoldenSuite, PicturesAreNamedByCaseAndFrame) {
  GoldenCase golden_case;
  golden_case.name = "robot";
  EXPECT_EQ(golden_picture(golden_case, 120), fs::path("robot/000120.png"));
}

}  // namespace
}  // namespace planecast::engine
