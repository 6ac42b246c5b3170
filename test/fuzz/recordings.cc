#include <array>

#include "engine/sequence/camera_file.h"
#include "engine/sequence/groundtruth.h"
#include "engine/sequence/image_file.h"
#include "engine/sequence/image_list_sequence.h"
#include "test/fuzz/memory_file.h"
#include "test/fuzz/target.h"

namespace planecast::fuzz {

void read_camera(std::string_view bytes) {
  const std::string& file = memory_file(bytes);
  answer([&] { engine::read_camera_file(file); });
  answer([&] { engine::read_body_from_cam(file); });
}

/// The first byte says which kind of list the rest is.
void read_lists(std::string_view bytes) {
  constexpr std::array<const char*, 5> kLists = {"rgb.txt", "associations.txt", "cam0/data.csv",
                                                 "depth.txt", "mask.txt"};
  if (bytes.empty()) return;
  const std::string& folder = memory_folder();
  const std::string name = kLists[static_cast<unsigned char>(bytes[0]) % kLists.size()];
  if (name == "depth.txt" || name == "mask.txt") {
    put_file(folder + "/rgb.txt", "0.0 rgb/0.png\n0.1 rgb/1.png\n");
  }
  put_file(folder + "/" + name, bytes.substr(1));
  answer([&] { engine::list_images(folder); });
}

void read_mask(std::string_view bytes) {
  const std::string& file = memory_file(bytes);
  answer([&] { engine::read_label_image(file); });
  answer([&] { engine::read_depth_image(file, 5000.0); });
  answer([&] { engine::read_color_image(file); });
}

void read_poses(std::string_view bytes) {
  answer([&] { engine::read_trajectory(memory_file(bytes)); });
  const std::string& folder = memory_folder();
  put_file(folder + "/mav0/cam0/sensor.yaml",
           "T_BS: {data: [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1]}\n");
  put_file(folder + "/mav0/state_groundtruth_estimate0/data.csv", bytes);
  answer([&] { engine::read_groundtruth(folder); });
}

}  // namespace planecast::fuzz
