// Times whole runs of the executable, causal and two-pass, beside 400 single-threaded calls of
// cv::ORB::detectAndCompute (1000 features) on the same pictures, before and after: the ratio holds
// on any machine. Usage: bench_run PLANECAST SEQUENCE SCENE OUT [CAMERA]. Prints Markdown.

#include <cstdio>
#include <exception>
#include <fstream>
#include <nlohmann/json.hpp>
#include <opencv2/core.hpp>
#include <stdexcept>
#include <string>
#include <vector>

#include "engine/sequence/sequence.h"
#include "test/bench/orb_call.h"

namespace planecast::bench {
namespace {

constexpr int kCalls = 400;

double orb_seconds(engine::Sequence& sequence) {
  OrbCall orb;
  const int frames = sequence.end_frame() - sequence.first_frame();
  double ms = 0.0;
  for (int i = 0; i < kCalls; ++i) {
    ms += orb.measure(sequence.read(sequence.first_frame() + i % frames).image).wall_ms;
  }
  return 1e-3 * ms;
}

struct Run {
  double seconds = 0.0;
  std::vector<std::string> steps;  ///< what --verbose says of times
};

std::string quoted(const std::string& text) { return "'" + text + "'"; }

Run time_run(const std::vector<std::string>& arguments) {
  std::string command;
  for (const std::string& argument : arguments) command += quoted(argument) + " ";
  Run run;
  const double begin = wall_ms();
  FILE* pipe = popen((command + "2>&1").c_str(), "r");
  if (pipe == nullptr) throw std::runtime_error("cannot start " + arguments.front());
  char line[512];
  while (std::fgets(line, sizeof(line), pipe) != nullptr) {
    const std::string text(line, std::char_traits<char>::length(line) - 1);
    if (text.find(" ms a frame") != std::string::npos) run.steps.push_back(text);
  }
  const int status = pclose(pipe);
  run.seconds = 1e-3 * (wall_ms() - begin);
  if (status != 0) throw std::runtime_error("the run failed: " + command);
  return run;
}

void print_mapping(const std::string& folder) {
  std::ifstream in(folder + "/timings.json");
  const nlohmann::json timings = nlohmann::json::parse(in);
  for (const auto& row : timings["rows"]) {
    if (row["count"].get<int>() == 0) continue;
    std::printf("| %s | %d | %.2f |\n", row["name"].get<std::string>().c_str(),
                row["count"].get<int>(), row["mean"].get<double>());
  }
}

int run(int count, char** arguments) {
  if (count < 5) {
    std::fputs("usage: bench_run PLANECAST SEQUENCE SCENE OUT [CAMERA]\n", stderr);
    return 2;
  }
  cv::setNumThreads(1);
  engine::SequenceOptions options;
  if (count > 5) options.camera = arguments[5];
  const auto sequence = engine::open_sequence(arguments[2], options);
  const std::string out = arguments[4];
  std::vector<std::string> command = {arguments[1], "run",           arguments[2], "--scene",
                                      arguments[3], "--no-progress", "--verbose"};
  if (count > 5) command.insert(command.end(), {"--camera", arguments[5]});
  const double orb_before = orb_seconds(*sequence);
  std::vector<std::string> causal = command;
  causal.insert(causal.end(), {"-o", out + "/causal", "--causal"});
  const Run causal_run = time_run(causal);
  std::vector<std::string> two_pass = command;
  two_pass.insert(two_pass.end(), {"-o", out + "/two-pass"});
  const Run two_pass_run = time_run(two_pass);
  const double orb = 0.5 * (orb_before + orb_seconds(*sequence));
  std::printf("| run | seconds | in %d calls of cv::ORB (%.2f s) |\n| --- | --- | --- |\n", kCalls,
              orb);
  std::printf("| --causal | %.2f | %.2f |\n", causal_run.seconds, causal_run.seconds / orb);
  std::printf("| two-pass | %.2f | %.2f |\n\n", two_pass_run.seconds, two_pass_run.seconds / orb);
  std::puts("| step of the two-pass run | count | mean ms |\n| --- | --- | --- |");
  print_mapping(out + "/two-pass");
  for (const std::string& step : two_pass_run.steps) std::puts(step.c_str());
  return 0;
}

}  // namespace
}  // namespace planecast::bench

int main(int count, char** arguments) {
  try {
    return planecast::bench::run(count, arguments);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 2;
  }
}
