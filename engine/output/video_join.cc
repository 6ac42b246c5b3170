#include "engine/output/video_join.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <limits>

#include "engine/output/libav.h"
#include "engine/user_error.h"

namespace planecast::engine {
namespace {

namespace fs = std::filesystem;

libav::Input open_segment(const fs::path& path) {
  AVFormatContext* context = nullptr;
  const int opened = avformat_open_input(&context, path.c_str(), nullptr, nullptr);
  libav::Input input(context);
  if (opened < 0 || context->nb_streams != 1) {
    throw UserError(fmt::format("{}: is not a readable video segment", path.string()));
  }
  return input;
}

bool same_coding(const AVCodecParameters& a, const AVCodecParameters& b) {
  return a.codec_id == b.codec_id && a.width == b.width && a.height == b.height &&
         a.extradata_size == b.extradata_size &&
         std::memcmp(a.extradata, b.extradata, static_cast<std::size_t>(a.extradata_size)) == 0;
}

/// Copies segment after segment, counting frames.
class Joiner {
 public:
  Joiner(const fs::path& path, FrameRate rate)
      : path_(path), frame_time_{rate.denominator, rate.numerator}, muxer_(path) {}

  void append(const fs::path& segment) {
    const libav::Input input = open_segment(segment);
    const AVStream* source = input->streams[0];
    if (stream_ == nullptr) {
      begin(*source);
    } else if (!same_coding(*stream_->codecpar, *source->codecpar)) {
      throw UserError(fmt::format("{}: was encoded with other settings than the segments before it",
                                  segment.string()));
    }
    std::int64_t frames = 0;
    const libav::Packet packet(av_packet_alloc());
    int result = 0;
    while ((result = av_read_frame(input.get(), packet.get())) >= 0) {
      copy(*packet, source->time_base);
      ++frames;
    }
    if (result != AVERROR_EOF) libav::fail(segment, result);
    first_frame_ += frames;
  }

  void commit() { muxer_.commit(); }

 private:
  void begin(const AVStream& source) {
    stream_ = muxer_.add_stream();
    libav::check(avcodec_parameters_copy(stream_->codecpar, source.codecpar), path_);
    stream_->codecpar->codec_tag = 0;
    stream_->time_base = frame_time_;
    stream_->avg_frame_rate = av_inv_q(frame_time_);
    stream_->sample_aspect_ratio = {1, 1};
    muxer_.write_header(true);
  }

  void copy(AVPacket& packet, AVRational time_base) {
    av_packet_rescale_ts(&packet, time_base, frame_time_);
    packet.pts += first_frame_;
    packet.dts += first_frame_;
    packet.duration = 1;
    // A short last segment may begin decoding later than the one before it ended.
    packet.dts = std::min(std::max(packet.dts, last_dts_ + 1), packet.pts);
    last_dts_ = packet.dts;
    muxer_.write(&packet, frame_time_);
  }

  fs::path path_;
  AVRational frame_time_;
  libav::Mp4Muxer muxer_;
  AVStream* stream_ = nullptr;
  std::int64_t first_frame_ = 0;
  std::int64_t last_dts_ = std::numeric_limits<std::int64_t>::min() / 2;
};

}  // namespace

void join_segments(const std::vector<fs::path>& segments, FrameRate rate, const fs::path& path) {
  Joiner joiner(path, rate);
  for (const fs::path& segment : segments) joiner.append(segment);
  joiner.commit();
}

}  // namespace planecast::engine
