#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>

#include "engine/assets.h"
#include "engine/benchmark/config.h"
#include "engine/benchmark/metrics.h"
#include "engine/benchmark/result_groups.h"
#include "engine/benchmark/result_plots.h"
#include "engine/benchmark/result_tables.h"
#include "engine/benchmark/svg.h"
#include "sequence_test_files.h"

namespace planecast::engine {
namespace {

namespace fs = std::filesystem;

TEST(BenchmarkConfig, ReadsAllThatIsDocumented) {
  TestFolder folder;
  setenv("PLANECAST_TEST_DATA", "/data", 1);
  folder.write("figures.yaml",
               "columns:\n  - {name: other, source: a paper, metric: ate_cm, mono: {a: 1.5}}\n");
  const auto file = folder.write(
      "config.yaml",
      "title: T\nabout: text\nseeds: [3, 9]\nmodes: [mono, rgbd]\ndata: PLANECAST_TEST_DATA\n"
      "options: [--threads, 1]\ntables: [ate, planes]\nplots: [ate]\n"
      "curves: [{x: frames, y: seconds}]\npublished: figures.yaml\n"
      "variants:\n  - name: default\n  - {name: bare, options: [--no-planes], modes: [mono]}\n"
      "sequences:\n"
      "  - {name: a, group: g, path: x, camera: tum-fr1, groundtruth: gt.txt, frames: '0:9'}\n"
      "  - {name: b, synth: {scene: corner, frames: 20, width: 320, height: 240, lens: wide},\n"
      "     modes: [rgbd], variants: [bare]}\n");
  const BenchmarkConfig config = read_benchmark_config(file);
  EXPECT_EQ(config.seeds, (std::vector<std::uint64_t>{3, 9}));
  EXPECT_EQ(config.options, (std::vector<std::string>{"--threads", "1"}));
  ASSERT_EQ(config.sequences.size(), 2U);
  EXPECT_EQ(config.sequences[0].path, fs::path("/data/x"));
  EXPECT_EQ(config.sequences[0].groundtruth, fs::path("/data/x/gt.txt"));
  EXPECT_EQ(config.sequences[0].modes, (std::vector<std::string>{"mono", "rgbd"}));
  ASSERT_TRUE(config.sequences[1].synth);
  EXPECT_EQ(config.sequences[1].synth->frames, 20);
  EXPECT_EQ(config.sequences[1].synth->lens, "wide");
  EXPECT_EQ(config.sequences[1].modes, std::vector<std::string>{"rgbd"});
  ASSERT_EQ(config.variants.size(), 2U);
  EXPECT_EQ(config.variants[1].options, std::vector<std::string>{"--no-planes"});
  ASSERT_EQ(config.published.size(), 1U);
  EXPECT_EQ(config.published[0].figures.at("mono").at("a"), "1.5");
}

TEST(BenchmarkConfig, ErrorsAreOneLineWithTheirPlace) {
  TestFolder folder;
  const auto error = [&folder](const std::string& text) {
    const auto file = folder.write("c.yaml", text);
    const std::string message = user_error([&] { read_benchmark_config(file); });
    EXPECT_EQ(message.find('\n'), std::string::npos);
    return message.substr(std::min(message.size(), file.parent_path().string().size() + 1));
  };
  const std::string one = "sequences:\n  - {name: a, path: x}\n";
  EXPECT_EQ(error(one + "sequence: 3\n"), "c.yaml:3: unknown key 'sequence'");
  EXPECT_EQ(error("sequences:\n  - {name: a, path: x, camra: y}\n"),
            "c.yaml:2: unknown key 'camra'");
  EXPECT_EQ(error("title: nothing\n"), "c.yaml: 'sequences' is missing or empty");
  EXPECT_EQ(error(one + "  - {name: a, path: y}\n"), "c.yaml:3: the name 'a' stands twice");
  EXPECT_EQ(error("sequences:\n  - {name: a}\n"),
            "c.yaml:2: a sequence needs either 'path' or 'synth'");
  EXPECT_EQ(error("sequences:\n  - {name: a, synth: {scene: moon}}\n"),
            "c.yaml:2: moon: no such synthetic scene");
  EXPECT_EQ(error("sequences:\n  - {name: a, path: x, variants: [none]}\n"),
            "c.yaml: sequence 'a': no variant 'none'");
  EXPECT_EQ(error(one + "seeds: 0\n"), "c.yaml:3: 'seeds' must be 1 to 100 or a list");
  EXPECT_NE(error(one + "modes: [stereo]\n").find("'stereo' in 'modes' is none of"),
            std::string::npos);
  EXPECT_NE(error("a: [b\n").find("not valid YAML"), std::string::npos);
  EXPECT_NE(
      user_error([&] { read_benchmark_config(folder.path() / "none.yaml"); }).find("none.yaml"),
      std::string::npos);
}

TEST(BenchmarkConfig, TheOnesOfTheProjectCanBeRead) {
  for (const char* name :
       {"builtin", "planes", "real", "ablation", "scaling", "table1", "table2"}) {
    const BenchmarkConfig config =
        read_benchmark_config(asset("benchmark/" + std::string(name) + ".yaml"));
    EXPECT_FALSE(config.sequences.empty()) << name;
  }
  const BenchmarkConfig table1 = read_benchmark_config(asset("benchmark/table1.yaml"));
  EXPECT_EQ(table1.sequences.size(), 16U);
  EXPECT_EQ(table1.seeds.size(), 5U);
  // Every figure of others belongs to a sequence that the table has.
  for (const PublishedColumn& column : table1.published) {
    if (column.metric != "ate_cm") continue;
    for (const char* mode : {"mono", "rgbd"}) {
      for (const auto& [sequence, figure] : column.figures.at(mode)) {
        EXPECT_TRUE(std::any_of(table1.sequences.begin(), table1.sequences.end(),
                                [&](const BenchmarkSequence& s) { return s.name == sequence; }))
            << column.name << " " << sequence;
      }
    }
  }
}

TEST(BenchmarkMetrics, WorstIsTheLeastWhereMoreIsBetter) {
  const Metrics a = {{"ate_cm", 1.0}, {"f_5", 0.9}};
  const Metrics b = {{"ate_cm", 3.0}, {"f_5", 0.5}};
  const Metrics c = {{"ate_cm", 1.4}, {"f_5", 0.8}};
  const MetricSummary ate = summarise_metric({&a, &b, &c}, metric_info("ate_cm"));
  EXPECT_DOUBLE_EQ(ate.median, 1.4);
  EXPECT_DOUBLE_EQ(ate.mean, 1.8);
  EXPECT_DOUBLE_EQ(ate.worst, 3.0);
  EXPECT_DOUBLE_EQ(summarise_metric({&a, &b, &c}, metric_info("f_5")).worst, 0.5);
  EXPECT_EQ(format_summary(ate, 2), "1.40 (1.80, 3.00)");
  EXPECT_EQ(format_summary(summarise_metric({&a}, metric_info("ate_cm")), 2), "1.00");
  EXPECT_EQ(format_summary({}, 2), "-");
}

/// Two sequences, two variants, two seeds; one run failed, one sequence is absent.
class BenchmarkTables : public testing::Test {
 protected:
  void SetUp() override {
    config.variants.resize(2);
    config.variants[1].name = "bare";
    config.sequences.resize(2);
    config.sequences[0].name = "desk|1";
    config.sequences[0].group = "g";
    config.sequences[1].name = "gone";
    config.published = {{"others", "a paper, Table 3", "ate_cm", {{"mono", {{"desk|1", "9.99"}}}}}};
    add(0, 0, 1, "ok",
        {{"ate_cm", 2.0}, {"seconds", 10.0}, {"frames", 100.0}, {"ms_per_frame", 9}});
    add(0, 0, 2, "ok",
        {{"ate_cm", 4.0}, {"seconds", 12.0}, {"frames", 100.0}, {"ms_per_frame", 9}});
    add(0, 1, 1, "ok", {{"ate_cm", 6.0}, {"mean_ms:Local BA", 30.0}, {"ms_per_frame", 18.0}});
    add(0, 1, 2, "failed: no, really", {});
    add(1, 0, 1, "not present", {});
  }
  void add(std::size_t sequence, std::size_t variant, std::uint64_t seed, const std::string& status,
           const Metrics& metrics) {
    BenchmarkRow row;
    row.run.sequence = &config.sequences[sequence];
    row.run.variant = &config.variants[variant];
    row.run.mode = "mono";
    row.run.seed = seed;
    row.status = status;
    row.metrics = metrics;
    rows.push_back(row);
  }

  BenchmarkConfig config;
  std::vector<BenchmarkRow> rows;
};

TEST_F(BenchmarkTables, FiguresOfOthersStandApartWithTheirSource) {
  const std::string table = benchmark_table("ate", config, group_rows(rows));
  EXPECT_NE(table.find("| sequence | variant | ATE cm | *others* | status |"), std::string::npos);
  EXPECT_NE(table.find("| desk\\|1 | default | 3.00 (3.00, 4.00) | 9.99 | ok |"),
            std::string::npos);
  EXPECT_NE(table.find("| 6.00 | 9.99 | 1 of 2 failed: no, really |"), std::string::npos);
  EXPECT_NE(table.find("| gone | default | - | - | not present |"), std::string::npos);
  EXPECT_NE(table.find("*others*: a paper, Table 3"), std::string::npos);
}

TEST_F(BenchmarkTables, VariantsAreComparedWithTheFirst) {
  const std::string table = benchmark_table("ablation", config, group_rows(rows));
  // 6 against a median of 3, 18 ms against 9.
  EXPECT_NE(table.find("| bare | 1 | 2.000 | 2.000 | 0 of 1 | - | - | 2.000 |"), std::string::npos)
      << table;
}

TEST_F(BenchmarkTables, NothingMeasuredMakesNoTable) {
  EXPECT_EQ(benchmark_table("overlay", config, group_rows(rows)), "");
}

TEST_F(BenchmarkTables, CsvHasALineForEachRun) {
  const std::string csv = benchmark_csv(rows);
  EXPECT_EQ(std::count(csv.begin(), csv.end(), '\n'), 6);
  EXPECT_EQ(csv.substr(0, 40), "sequence,group,mode,variant,seed,status,");
  EXPECT_NE(csv.find("desk|1,g,mono,default,1,ok,100,2,"), std::string::npos);
  EXPECT_NE(csv.find("\"failed: no, really\""), std::string::npos);
  EXPECT_NE(csv.find(",mean_ms:Local BA\n"), std::string::npos);
}

TEST_F(BenchmarkTables, PlotsShowWhatWasMeasured) {
  const std::string bars = ate_bars_svg(group_rows(rows));
  EXPECT_EQ(bars.substr(0, 4), "<svg");
  EXPECT_NE(bars.find("desk|1 mono"), std::string::npos);
  EXPECT_NE(bars.find(">3.00<"), std::string::npos);
  EXPECT_EQ(bars.find("gone"), std::string::npos);
  const std::string curve = curve_svg({"frames", "seconds"}, group_rows(rows));
  EXPECT_NE(curve.find("time s against frames"), std::string::npos);
  EXPECT_EQ(curve_svg({"frames", "jitter_px"}, group_rows(rows)), "");
  const std::string paths =
      paths_svg({{"p & q", {{0, 0, 0}, {2, 0, 0}, {2, 1, 0}}, {{0, 0, 0}, {2, 0.1, 0}}}});
  EXPECT_NE(paths.find("p &amp; q"), std::string::npos);
  EXPECT_NE(paths.find(">0.5 m<"), std::string::npos);  // 0.4 of an extent of 2 m, rounded down
}

TEST(Svg, TicksAreRound) {
  EXPECT_EQ(axis_ticks(10.0), (std::vector<double>{0, 2, 4, 6, 8, 10}));
  EXPECT_EQ(axis_ticks(0.9).size(), 5U);  // 0, 0.2, ... 0.8
  EXPECT_EQ(axis_ticks(0.0), std::vector<double>{0.0});
}

}  // namespace
}  // namespace planecast::engine
