#include "engine/output/video_segment.h"

#include <fmt/format.h>

#include <opencv2/imgproc.hpp>

#include "engine/user_error.h"

namespace planecast::engine {
namespace {

/// x264's bytes depend on its number of threads, so that it is the same for every --threads. More
/// than two would help no machine on which the frames are also drawn.
constexpr int kEncoderThreads = 2;
/// Lines from which video is taken to be in the HD colour space, as players guess for untagged
/// files.
constexpr int kHdLines = 720;

int round_up_to_even(int value) { return value + value % 2; }

void tag_colors(AVCodecContext& encoder) {
  const bool hd = encoder.height >= kHdLines;
  encoder.color_range = AVCOL_RANGE_MPEG;
  encoder.colorspace = hd ? AVCOL_SPC_BT709 : AVCOL_SPC_SMPTE170M;
  encoder.color_primaries = hd ? AVCOL_PRI_BT709 : AVCOL_PRI_SMPTE170M;
  encoder.color_trc = hd ? AVCOL_TRC_BT709 : AVCOL_TRC_SMPTE170M;
  encoder.chroma_sample_location = AVCHROMA_LOC_LEFT;
}

}  // namespace

VideoWriter::Segment::Segment(const std::filesystem::path& path, cv::Size size, FrameRate rate,
                              const VideoOptions& options)
    : path_(path),
      size_(size),
      even_size_(round_up_to_even(size.width), round_up_to_even(size.height)),
      rate_(rate),
      muxer_(path),
      frame_(av_frame_alloc()),
      packet_(av_packet_alloc()) {
  open_encoder(options);
  open_scaler();
  AVStream* stream = muxer_.add_stream();
  stream->time_base = encoder_->time_base;
  stream->avg_frame_rate = encoder_->framerate;
  libav::check(avcodec_parameters_from_context(stream->codecpar, encoder_.get()), path_);
  muxer_.write_header(false);
}

void VideoWriter::Segment::open_encoder(const VideoOptions& options) {
  const AVCodec* codec = avcodec_find_encoder_by_name("libx264");
  if (codec == nullptr) {
    throw UserError(fmt::format("{}: FFmpeg's libraries have no libx264", path_.string()));
  }
  encoder_.reset(avcodec_alloc_context3(codec));
  encoder_->width = even_size_.width;
  encoder_->height = even_size_.height;
  encoder_->pix_fmt = AV_PIX_FMT_YUV420P;
  encoder_->time_base = {rate_.denominator, rate_.numerator};
  encoder_->framerate = {rate_.numerator, rate_.denominator};
  encoder_->sample_aspect_ratio = {1, 1};
  encoder_->gop_size = options.segment_frames;
  encoder_->thread_count = kEncoderThreads;
  encoder_->flags |= AV_CODEC_FLAG_BITEXACT | AV_CODEC_FLAG_CLOSED_GOP;
  if (muxer_.wants_global_header()) encoder_->flags |= AV_CODEC_FLAG_GLOBAL_HEADER;
  tag_colors(*encoder_);
  AVDictionary* settings = nullptr;
  av_dict_set(&settings, "preset", options.preset.c_str(), 0);
  av_dict_set_int(&settings, "crf", options.crf, 0);
  // Else x264's macroblock tree is computed by instructions that round differently from processor
  // to processor, and with AVX-512 from run to run.
  av_dict_set(&settings, "x264-params", "cpu-independent=1", 0);
  const int opened = avcodec_open2(encoder_.get(), codec, &settings);
  av_dict_free(&settings);
  libav::check(opened, path_);
}

void VideoWriter::Segment::open_scaler() {
  const int width = even_size_.width;
  const int height = even_size_.height;
  scaler_.reset(sws_getContext(width, height, AV_PIX_FMT_BGR24, width, height, AV_PIX_FMT_YUV420P,
                               SWS_BICUBIC | SWS_ACCURATE_RND | SWS_BITEXACT | SWS_FULL_CHR_H_INP,
                               nullptr, nullptr, nullptr));
  if (!scaler_) libav::fail(path_, AVERROR(EINVAL));
  const int* matrix = sws_getCoefficients(height >= kHdLines ? SWS_CS_ITU709 : SWS_CS_SMPTE170M);
  constexpr int kUnit = 1 << 16;
  const int result = sws_setColorspaceDetails(scaler_.get(), matrix, 1, matrix, 0, 0, kUnit, kUnit);
  if (result < 0) libav::fail(path_, AVERROR(EINVAL));
  frame_->format = AV_PIX_FMT_YUV420P;
  frame_->width = width;
  frame_->height = height;
  libav::check(av_frame_get_buffer(frame_.get(), 0), path_);
}

void VideoWriter::Segment::write(const cv::Mat& bgr) {
  cv::Mat padded = bgr;
  if (even_size_ != size_) {
    cv::copyMakeBorder(bgr, padded, 0, even_size_.height - size_.height, 0,
                       even_size_.width - size_.width, cv::BORDER_REPLICATE);
  }
  libav::check(av_frame_make_writable(frame_.get()), path_);
  const std::uint8_t* planes[1] = {padded.data};
  const int strides[1] = {static_cast<int>(padded.step)};
  sws_scale(scaler_.get(), planes, strides, 0, padded.rows, frame_->data, frame_->linesize);
  frame_->pts = next_frame_++;
  libav::check(avcodec_send_frame(encoder_.get(), frame_.get()), path_);
  drain();
}

void VideoWriter::Segment::finish() {
  libav::check(avcodec_send_frame(encoder_.get(), nullptr), path_);
  drain();
  muxer_.commit();
}

void VideoWriter::Segment::drain() {
  while (true) {
    const int result = avcodec_receive_packet(encoder_.get(), packet_.get());
    if (result == AVERROR(EAGAIN) || result == AVERROR_EOF) return;
    libav::check(result, path_);
    packet_->duration = 1;
    muxer_.write(packet_.get(), encoder_->time_base);
  }
}

}  // namespace planecast::engine
