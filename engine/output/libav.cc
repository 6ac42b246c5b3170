#include "engine/output/libav.h"

#include <fmt/format.h>

#include <system_error>

#include "engine/output/atomic_file.h"
#include "engine/user_error.h"

namespace planecast::engine::libav {

void fail(const std::filesystem::path& path, int error) {
  char reason[AV_ERROR_MAX_STRING_SIZE] = {};
  av_strerror(error, reason, sizeof(reason));
  throw UserError(fmt::format("{}: cannot write video: {}", path.string(), reason));
}

int check(int result, const std::filesystem::path& path) {
  if (result < 0) fail(path, result);
  return result;
}

Mp4Muxer::Mp4Muxer(const std::filesystem::path& path) : path_(path) {
  const std::string temporary = temporary_path(path).string();
  check(avformat_alloc_output_context2(&context_, nullptr, "mp4", temporary.c_str()), path_);
  context_->flags |= AVFMT_FLAG_BITEXACT;
  const int opened = avio_open(&context_->pb, temporary.c_str(), AVIO_FLAG_WRITE);
  if (opened < 0) {
    avformat_free_context(context_);
    fail(path_, opened);
  }
}

Mp4Muxer::~Mp4Muxer() {
  if (context_ == nullptr) return;
  avio_closep(&context_->pb);
  avformat_free_context(context_);
  std::error_code ignored;
  std::filesystem::remove(temporary_path(path_), ignored);
}

bool Mp4Muxer::wants_global_header() const {
  return (context_->oformat->flags & AVFMT_GLOBALHEADER) != 0;
}

AVStream* Mp4Muxer::add_stream() {
  AVStream* stream = avformat_new_stream(context_, nullptr);
  if (stream == nullptr) fail(path_, AVERROR(ENOMEM));
  return stream;
}

void Mp4Muxer::write_header(bool fast_start) {
  AVDictionary* options = nullptr;
  if (fast_start) av_dict_set(&options, "movflags", "+faststart", 0);
  const int result = avformat_write_header(context_, &options);
  av_dict_free(&options);
  check(result, path_);
}

void Mp4Muxer::write(AVPacket* packet, AVRational packet_time_base) {
  packet->stream_index = 0;
  av_packet_rescale_ts(packet, packet_time_base, context_->streams[0]->time_base);
  check(av_interleaved_write_frame(context_, packet), path_);
}

void Mp4Muxer::commit() {
  check(av_write_trailer(context_), path_);
  // Written bytes may be refused as late as here, where the disk is full.
  const int pending = context_->pb->error;
  const int closed = avio_closep(&context_->pb);
  check(pending, path_);
  check(closed, path_);
  avformat_free_context(context_);
  context_ = nullptr;
  commit_file(path_);
}

}  // namespace planecast::engine::libav
