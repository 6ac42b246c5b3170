#include "engine/output/report.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "engine/assets.h"
#include "engine/output/base64.h"
#include "engine/output/report_charts.h"
#include "engine/output/report_data.h"
#include "engine/output/report_mesh.h"
#include "engine/output/report_page.h"
#include "render/gltf/import.h"
#include "test/unit/engine/output_test_files.h"
#include "test/unit/engine/table_world.h"

namespace planecast::engine {
namespace {

std::string report_of(const Reconstruction& reconstruction, const ReportInput& input,
                      const TestFolder& folder = {}) {
  write_report(reconstruction, input, folder / "report.html");
  return read_file(folder / "report.html");
}

bool has(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

/// What is left when the block that may differ is cut out.
std::string without_times(const std::string& html) {
  const std::size_t begin = html.find(kTimesBegin);
  const std::size_t end = html.find(kTimesEnd);
  EXPECT_NE(begin, std::string::npos);
  EXPECT_NE(end, std::string::npos);
  return html.substr(0, begin) + html.substr(end);
}

ObjectRecord block() {
  ObjectRecord object;
  object.name = "block </script>";
  object.plane = 1;
  object.world_from_model.translation() = Eigen::Vector3d(0.1, 0.5, 1.5);
  object.box = {Eigen::Vector3d(-1, 0, -1), Eigen::Vector3d(1, 2, 1)};
  return object;
}

TEST(Report, IsSelfContainedAndEscaped) {
  Reconstruction world = table_world();
  world.warnings = {"camera <guessed> & so on"};
  ReportInput input;
  input.title = "a <b> run";
  input.command = "planecast run 'a <b>'";
  input.versions = {{"OpenCV", "4.6.0"}};
  input.stills.push_back({"frame 3", cv::Mat(1200, 1600, CV_8UC3, cv::Scalar(1, 2, 3))});
  input.facts.emplace_back("Sequence", "room");
  input.links = {"augmented.mp4"};
  const std::string html = report_of(world, input);
  for (const char* expected :
       {"a &lt;b&gt; run", "camera &lt;guessed&gt; &amp; so on", "data:image/jpeg;base64,", "<svg",
        "plane 0, floor", "2 of 3 (66.7 %)", "Sequence", "href=\"augmented.mp4\"", "viewport",
        "planecast run 'a &lt;b&gt;'", "4.6.0", "prefers-color-scheme"}) {
    EXPECT_TRUE(has(html, expected)) << expected;
  }
  for (const char* outside : {"http://", "https://", "src=\"//", "<link", "@import", "url("}) {
    EXPECT_FALSE(has(html, outside)) << outside;
  }
}

TEST(Report, EmptyReconstructionHasAReport) {
  Reconstruction empty;
  empty.camera = test_camera();
  const std::string html = without_times(report_of(empty, {}));
  EXPECT_FALSE(has(html, "nan"));
  EXPECT_FALSE(has(html, "inf\""));
}

TEST(Report, OnlyTheBlockOfTimesDependsOnTimes) {
  Reconstruction world = table_world();
  ReportInput input;
  world.frame_times = {{{"Tracking", 10.0}}, {}, {{"Tracking", 20.0}}};
  world.mapping_times = {{"Local BA", {3.0}}};
  input.render_times[10] = {{"draw", 5.0}};
  const std::string first = report_of(world, input);
  world.frame_times[0][0].second = 99.0;
  world.mapping_times = {{"Local BA", {7.0, 8.0}}};
  input.render_times.clear();
  const std::string second = report_of(world, input);
  EXPECT_NE(first, second);
  EXPECT_EQ(without_times(first), without_times(second));
  EXPECT_TRUE(has(first, "render: draw"));
}

TEST(Report, SmallVideosAreCarriedAndLargeOnesLinked) {
  const TestFolder folder;
  write_file(folder / "augmented.mp4", std::string(3000, 'v'));
  ReportInput input;
  input.video = folder / "augmented.mp4";
  input.links = {"augmented.mp4"};
  input.stills.push_back({"frame 3", cv::Mat(48, 64, CV_8UC3, cv::Scalar(1, 2, 3))});
  const std::string small = report_of(table_world(), input, folder);
  EXPECT_TRUE(has(small, base64(std::string(3000, 'v'))));
  EXPECT_FALSE(has(small, "<figcaption>frame 3"));
  input.max_video_bytes = 2999;
  const std::string large = report_of(table_world(), input, folder);
  EXPECT_FALSE(has(large, "<video"));
  EXPECT_TRUE(has(large, "<figcaption>frame 3"));
  EXPECT_TRUE(has(large, "href=\"augmented.mp4\""));
}

TEST(Report, DataIsJsonThatCannotEndItsElement) {
  const Reconstruction world = table_world();
  ReportInput input;
  input.objects = {block()};
  const std::string html = report_of(world, input);
  const std::string open = "id=\"data\">";
  const std::size_t begin = html.find(open) + open.size();
  const auto data =
      nlohmann::json::parse(html.substr(begin, html.find("</script>", begin) - begin));
  EXPECT_EQ(data["frames"]["index"], (std::vector<int>{10, 11, 12}));
  EXPECT_TRUE(data["frames"]["pose"][1].is_null());
  EXPECT_NEAR(data["frames"]["pose"][2][0].get<double>(), 0.2, 1e-9);
  EXPECT_EQ(data["states"][data["frames"]["state"][1].get<std::size_t>()], "lost");
  EXPECT_EQ(data["planes"][1]["outer"].size(), 4U);
  EXPECT_EQ(data["objects"][0]["name"], "block </script>");
  EXPECT_NEAR(data["objects"][0]["matrix"][14].get<double>(), 1.5, 1e-9);
}

TEST(Report, ManyPointsAreThinned) {
  Reconstruction world = table_world();
  world.points.resize(70000);
  const auto data = nlohmann::json::parse(report_data_json(world, {}));
  EXPECT_LE(data["points"]["count"].get<int>(), 30000);
  EXPECT_GE(data["points"]["count"].get<int>(), 15000);
  EXPECT_EQ(data["points"]["plane"].get<std::string>().size(),
            (data["points"]["count"].get<std::size_t>() * 2 + 2) / 3 * 4);
}

TEST(Report, ScriptsCannotEndTheirElement) {
  EXPECT_EQ(script_text("a = \"</script>\" + \"</b>\";"), "a = \"<\\/script>\" + \"<\\/b>\";");
  EXPECT_EQ(script_json("{\"a\":\"</script>\"}"), "{\"a\":\"\\u003c/script>\"}");
}

TEST(Report, AModelsMeshIsItsRestPoseInFewTriangles) {
  for (const char* name : {"models/robot.glb", "models/vase.glb"}) {
    const auto model = render::import_gltf(asset(name)).model;
    ASSERT_TRUE(model);
    const ReportMesh mesh = report_mesh(*model);
    ASSERT_FALSE(mesh.triangles.empty()) << name;
    EXPECT_LE(mesh.triangles.size() / 3, 12000U);
    ASSERT_EQ(mesh.colors_srgb.size(), mesh.positions.size());
    const std::uint32_t last = *std::max_element(mesh.triangles.begin(), mesh.triangles.end());
    EXPECT_EQ(last, mesh.positions.size() / 3 - 1);
    const render::Bounds bounds = render::model_bounds(*model);
    for (int axis = 0; axis < 3; ++axis) {
      float low = 1e9F;
      float high = -1e9F;
      for (std::size_t i = static_cast<std::size_t>(axis); i < mesh.positions.size(); i += 3) {
        low = std::min(low, mesh.positions[i]);
        high = std::max(high, mesh.positions[i]);
      }
      const float side = bounds.max[axis] - bounds.min[axis];
      EXPECT_NEAR(low, bounds.min[axis], 0.05F * side) << name << axis;
      EXPECT_NEAR(high, bounds.max[axis], 0.05F * side) << name << axis;
    }
  }
}

TEST(Base64, MatchesTheStandardsExamples) {
  EXPECT_EQ(base64(""), "");
  EXPECT_EQ(base64("f"), "Zg==");
  EXPECT_EQ(base64("fo"), "Zm8=");
  EXPECT_EQ(base64("foobar"), "Zm9vYmFy");
}

TEST(Charts, TheLaneNamesStatesReasonsAndFrames) {
  const Reconstruction world = table_world();
  const std::string html = inlier_chart_html(world);
  EXPECT_TRUE(has(html, "<rect class=\"s-lost\" x=\"1\" width=\"1\""));
  EXPECT_TRUE(has(html, "frames 11 to 11: lost, too few matches"));
  EXPECT_TRUE(has(state_legend_html(world), "lost: 1 <small>(1 too few matches)</small>"));
}

TEST(Charts, LongRunsAreThinnedToTheFewestInliers) {
  Reconstruction world = table_world();
  world.frames.assign(6000, world.frames.front());
  for (FrameRecord& frame : world.frames) frame.inliers = 100;
  world.frames[3000].inliers = 0;
  const std::string html = inlier_chart_html(world);
  EXPECT_TRUE(has(html, "viewBox=\"0 0 1200 100\""));
  EXPECT_TRUE(has(html, "V100.00H601")) << "the dip of frame 3000 is lost";
}

TEST(Charts, TimesAreStackedInTheOrderOfTheStages) {
  Reconstruction world = table_world();
  world.frame_times = {{{"one", 10.0}, {"two", 30.0}}, {{"one", 10.0}}, {{"one", 10.0}}};
  const std::string html = times_chart_html(world, {});
  // The highest sum, 40 ms, reaches 94 % of the height; one quarter of it is the first stage.
  EXPECT_TRUE(has(html, "class=\"c0\" d=\"M0,76.50H1")) << html;
  EXPECT_TRUE(has(html, "class=\"c1\" d=\"M0,6.00H1")) << html;
  EXPECT_EQ(times_chart_html(table_world(), {}), "");
}

}  // namespace
}  // namespace planecast::engine
