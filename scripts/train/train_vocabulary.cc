// Trains the place-recognition vocabulary from sequences:
//   train_vocabulary OUTPUT SEED SEQUENCE...
// and prints what went into it. Run by scripts/train/vocabulary.sh.
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <filesystem>
#include <fstream>
#include <opencv2/imgproc.hpp>

#include "engine/sequence/sequence.h"
#include "slam/features/orb.h"
#include "slam/features/vocabulary.h"

namespace {

using namespace planecast;

void add_images(const char* path, slam::OrbExtractor& extractor,
                std::vector<std::vector<slam::Descriptor>>& images) {
  const std::unique_ptr<engine::Sequence> sequence = engine::open_sequence(path, {});
  for (int index = sequence->first_frame(); index < sequence->end_frame(); ++index) {
    cv::Mat grey = sequence->read(index).image;
    if (grey.channels() == 3) cv::cvtColor(grey, grey, cv::COLOR_BGR2GRAY);
    images.push_back(extractor.extract(grey, sequence->camera()).descriptors);
  }
}

int train(int argc, char** argv) {
  slam::VocabularyTraining training;
  training.seed = std::strtoull(argv[2], nullptr, 10);
  slam::OrbExtractor extractor{slam::OrbOptions{}};
  std::vector<std::vector<slam::Descriptor>> images;
  for (int i = 3; i < argc; ++i) add_images(argv[i], extractor, images);
  std::size_t descriptors = 0;
  for (const auto& image : images) descriptors += image.size();
  if (descriptors == 0) {
    std::fprintf(stderr, "train_vocabulary: the images have no features\n");
    return 2;
  }
  const slam::Vocabulary vocabulary = slam::train_vocabulary(images, training);
  std::ofstream out(argv[1], std::ios::binary);
  vocabulary.write(out);
  out.close();
  if (!out) {
    std::fprintf(stderr, "%s: cannot be written\n", argv[1]);
    return 2;
  }
  std::printf(
      "seed %llu\nbranches %d\ndepth %d\nimages %zu\ndescriptors %zu\nnodes %zu\nwords %d\n"
      "bytes %ju\n",
      static_cast<unsigned long long>(training.seed), training.branches, training.depth,
      images.size(), descriptors, vocabulary.size(), vocabulary.words(),
      static_cast<std::uintmax_t>(std::filesystem::file_size(argv[1])));
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 4) {
    std::fprintf(stderr, "usage: train_vocabulary OUTPUT SEED SEQUENCE...\n");
    return 2;
  }
  try {
    return train(argc, argv);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 2;
  }
}
