#pragma once

extern "C" {
#include <libavcodec/avcodec.h>
#include <libavformat/avformat.h>
#include <libavutil/opt.h>
#include <libswscale/swscale.h>
}

#include <filesystem>
#include <memory>
#include <string>

namespace planecast::engine::libav {

struct CodecContextFree {
  void operator()(AVCodecContext* context) const { avcodec_free_context(&context); }
};
struct FrameFree {
  void operator()(AVFrame* frame) const { av_frame_free(&frame); }
};
struct PacketFree {
  void operator()(AVPacket* packet) const { av_packet_free(&packet); }
};
struct ScalerFree {
  void operator()(SwsContext* context) const { sws_freeContext(context); }
};
struct InputClose {
  void operator()(AVFormatContext* context) const { avformat_close_input(&context); }
};

using CodecContext = std::unique_ptr<AVCodecContext, CodecContextFree>;
using Frame = std::unique_ptr<AVFrame, FrameFree>;
using Packet = std::unique_ptr<AVPacket, PacketFree>;
using Scaler = std::unique_ptr<SwsContext, ScalerFree>;
using Input = std::unique_ptr<AVFormatContext, InputClose>;

/// "Name: reason", thrown as UserError.
[[noreturn]] void fail(const std::filesystem::path& path, int error);
/// Passes non-negative results on, fails otherwise.
int check(int result, const std::filesystem::path& path);

/// An MP4 with one stream, written under the temporary name of `path` (atomic_file.h).
class Mp4Muxer {
 public:
  explicit Mp4Muxer(const std::filesystem::path& path);
  ~Mp4Muxer();
  Mp4Muxer(const Mp4Muxer&) = delete;
  Mp4Muxer& operator=(const Mp4Muxer&) = delete;

  bool wants_global_header() const;
  AVStream* add_stream();
  /// `fast_start`: the index goes before the pictures, so that the file plays while it loads.
  void write_header(bool fast_start);
  /// Takes the packet's content; times in the time base of `packet_time_base`.
  void write(AVPacket* packet, AVRational packet_time_base);
  /// Writes the index and renames the file to its final name.
  void commit();

 private:
  std::filesystem::path path_;
  AVFormatContext* context_ = nullptr;
};

}  // namespace planecast::engine::libav
