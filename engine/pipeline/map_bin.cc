#include "engine/pipeline/map_bin.h"

#include <fmt/format.h>

#include <cmath>
#include <cstdint>
#include <future>
#include <opencv2/imgcodecs.hpp>
#include <string>
#include <string_view>

#include "engine/output/atomic_file.h"
#include "engine/user_error.h"
#include "slam/data/byte_stream.h"
#include "slam/data/map_archive.h"
#include "slam/features/pyramid.h"

namespace planecast::engine {
namespace {

using slam::ByteReader;
using slam::ByteWriter;

constexpr std::string_view kMagic("PLNCMAP\0", 8);
constexpr std::uint32_t kVersion = 3;

[[noreturn]] void fail(const std::filesystem::path& path, const std::string& reason) {
  throw UserError(fmt::format("{}: {}", path.string(), reason));
}

void put_camera(const slam::Camera& camera, ByteWriter& out) {
  out.put(static_cast<std::int32_t>(camera.lens));
  out.put(static_cast<std::int32_t>(camera.width));
  out.put(static_cast<std::int32_t>(camera.height));
  for (const double value : {camera.fx, camera.fy, camera.cx, camera.cy}) out.put(value);
  for (const double value : camera.distortion) out.put(value);
  out.put(static_cast<std::uint8_t>(camera.guessed));
}

slam::Camera take_camera(ByteReader& in, const std::filesystem::path& path) {
  slam::Camera camera;
  const auto lens = in.number<std::int32_t>();
  if (lens != 0 && lens != 1) fail(path, "names an unknown lens model");
  camera.lens = static_cast<slam::LensModel>(lens);
  camera.width = in.number<std::int32_t>();
  camera.height = in.number<std::int32_t>();
  for (double* value : {&camera.fx, &camera.fy, &camera.cx, &camera.cy})
    *value = in.number<double>();
  for (double& value : camera.distortion) value = in.number<double>();
  camera.guessed = in.number<std::uint8_t>() != 0;
  constexpr int kMostPixels = 1 << 15;
  const bool size_is_sound = camera.width > 0 && camera.height > 0 && camera.width <= kMostPixels &&
                             camera.height <= kMostPixels;
  if (!size_is_sound || !(camera.fx > 0.0) || !(std::abs(camera.fy) > 0.0)) {
    fail(path, "has an impossible camera");
  }
  return camera;
}

void put_about(const Reconstruction& reconstruction, ByteWriter& out) {
  out.put(static_cast<std::uint8_t>(reconstruction.metric));
  out.put(reconstruction.median_depth);
  out.put(std::string_view(reconstruction.mode));
  out.put(std::string_view(reconstruction.segmentation));
  out.put(static_cast<std::uint64_t>(reconstruction.warnings.size()));
  for (const std::string& warning : reconstruction.warnings) out.put(std::string_view(warning));
}

void take_about(ByteReader& in, Reconstruction& reconstruction) {
  reconstruction.metric = in.number<std::uint8_t>() != 0;
  reconstruction.median_depth = in.number<double>();
  reconstruction.mode = in.text();
  reconstruction.segmentation = in.text();
  reconstruction.warnings.resize(in.count(sizeof(std::uint64_t)));
  for (std::string& warning : reconstruction.warnings) warning = in.text();
}

void put_pictures(const slam::Map& map, ByteWriter& out) {
  std::vector<const slam::Keyframe*> shown;
  for (const slam::Keyframe& keyframe : map.keyframes) {
    if (keyframe.pyramid == nullptr || keyframe.pyramid->levels.empty()) continue;
    shown.push_back(&keyframe);
  }
  std::vector<std::vector<unsigned char>> pngs(shown.size());
  // Photographs repeat nothing: Huffman's code alone is smaller than the quickest search for
  // repetitions, in three quarters of its time.
  const std::vector<int> settings = {cv::IMWRITE_PNG_COMPRESSION, 1, cv::IMWRITE_PNG_STRATEGY,
                                     cv::IMWRITE_PNG_STRATEGY_HUFFMAN_ONLY};
  const auto encode_every_second = [&](std::size_t first) {
    for (std::size_t k = first; k < shown.size(); k += 2) {
      cv::imencode(".png", shown[k]->pyramid->levels.front(), pngs[k], settings);
    }
  };
  std::future<void> others = std::async(std::launch::async, encode_every_second, 1);
  encode_every_second(0);
  others.get();
  for (std::size_t k = 0; k < shown.size(); ++k) {
    out.put(static_cast<std::int32_t>(shown[k]->id));
    out.put(std::string_view(reinterpret_cast<const char*>(pngs[k].data()), pngs[k].size()));
  }
}

void take_pictures(ByteReader& in, const std::filesystem::path& path, const slam::Camera& camera,
                   slam::Map& map) {
  while (in.ok() && !in.at_end()) {
    slam::Keyframe* keyframe = map.keyframes.find(in.number<std::int32_t>());
    const std::string png = in.text();
    if (!in.ok() || keyframe == nullptr) fail(path, "is broken");
    cv::Mat grey;
    try {
      const cv::Mat bytes(1, static_cast<int>(png.size()), CV_8U, const_cast<char*>(png.data()));
      if (!png.empty()) grey = cv::imdecode(bytes, cv::IMREAD_GRAYSCALE);
    } catch (const cv::Exception&) {
      grey.release();
    }
    if (grey.cols != camera.width || grey.rows != camera.height) {
      fail(path, "has a broken picture");
    }
    keyframe->pyramid = std::make_shared<const slam::ImagePyramid>(slam::build_pyramid(grey));
  }
}

void put_chunk(std::string_view tag, std::string_view payload, ByteWriter& out) {
  for (const char c : tag) out.put(c);
  out.put(payload);
}

/// Checks the header and returns what follows it.
std::string_view checked_body(std::string_view bytes, const std::filesystem::path& path) {
  if (!bytes.starts_with(kMagic)) fail(path, "is not a map of this program");
  ByteReader in(bytes.substr(kMagic.size()));
  const auto version = in.number<std::uint32_t>();
  if (in.ok() && version != kVersion) {
    fail(path,
         fmt::format("has version {}, not {}: make the reconstruction anew", version, kVersion));
  }
  const auto size = in.number<std::uint64_t>();
  const auto checksum = in.number<std::uint64_t>();
  const std::string_view body = in.take(size);
  if (!in.ok()) fail(path, "is truncated");
  if (!in.at_end() || slam::checksum_of(body) != checksum) {
    fail(path, "is damaged (its checksum is wrong)");
  }
  return body;
}

}  // namespace

void write_map_bin(const Reconstruction& reconstruction, const std::filesystem::path& path) {
  ByteWriter camera;
  put_camera(reconstruction.camera, camera);
  ByteWriter about;
  put_about(reconstruction, about);
  ByteWriter body;
  put_chunk("CAMR", camera.bytes(), body);
  put_chunk("ABOU", about.bytes(), body);
  if (reconstruction.map != nullptr) {
    put_chunk("SLAM", slam::MapArchive::encode(*reconstruction.map), body);
    ByteWriter pictures;
    put_pictures(*reconstruction.map, pictures);
    put_chunk("PICT", pictures.bytes(), body);
  }
  ByteWriter header;
  for (const char c : kMagic) header.put(c);
  header.put(kVersion);
  header.put(static_cast<std::uint64_t>(body.bytes().size()));
  header.put(slam::checksum_of(body.bytes()));
  write_file(path, header.bytes() + body.bytes());
}

void read_map_bin(const std::filesystem::path& path, Reconstruction& reconstruction,
                  bool with_map) {
  const std::string bytes = read_file(path);
  ByteReader body(checked_body(bytes, path));
  bool has_camera = false;
  std::optional<slam::Map> map;
  while (body.ok() && !body.at_end()) {
    const std::string_view tag = body.take(4);
    ByteReader chunk(body.take(body.number<std::uint64_t>()));
    if (tag == "CAMR") {
      reconstruction.camera = take_camera(chunk, path);
      has_camera = true;
    } else if (tag == "ABOU") {
      take_about(chunk, reconstruction);
    } else if (tag == "SLAM" && with_map && has_camera) {
      map = slam::MapArchive::decode(chunk.rest(), reconstruction.camera);
      if (!map) fail(path, "is broken");
    } else if (tag == "PICT" && map) {
      take_pictures(chunk, path, reconstruction.camera, *map);
    }
    if (!chunk.ok()) fail(path, "is truncated");
  }
  if (!body.ok()) fail(path, "is truncated");
  if (!has_camera) fail(path, "has no camera");
  if (map) reconstruction.map = std::make_shared<const slam::Map>(*std::move(map));
}

}  // namespace planecast::engine
