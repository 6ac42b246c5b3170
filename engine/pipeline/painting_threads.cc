#include "engine/pipeline/painting_threads.h"

#include <utility>

namespace planecast::engine {
namespace {

/// One frame being painted and one waiting.
constexpr std::size_t kPerThread = 2;

PaintedFrame paint_or_fail(const PaintingThreads::Paint& paint, const ReadFrame& frame) {
  try {
    return paint(frame);
  } catch (...) {
    PaintedFrame failed;
    failed.index = frame.index;
    failed.failure = std::current_exception();
    return failed;
  }
}

}  // namespace

PaintingThreads::Worker::Worker() : frames(kPerThread), painted(kPerThread) {}

PaintingThreads::PaintingThreads(std::function<Paint()> make, int threads)
    : make_(std::move(make)) {
  for (int i = 0; threads > 1 && i < threads; ++i) {
    Worker& worker = *workers_.emplace_back(std::make_unique<Worker>());
    worker.thread = std::thread([this, &worker] { work(worker); });
  }
}

PaintingThreads::~PaintingThreads() {
  for (const auto& worker : workers_) {
    worker->frames.close();
    worker->painted.close();
  }
  for (const auto& worker : workers_) worker->thread.join();
}

bool PaintingThreads::full() const {
  const std::size_t most = workers_.empty() ? 1 : kPerThread * workers_.size();
  return put_ - taken_ >= most;
}

void PaintingThreads::put(ReadFrame frame) {
  const std::size_t number = put_++;
  if (!workers_.empty()) {
    workers_[number % workers_.size()]->frames.push(std::move(frame));
    return;
  }
  if (!own_) own_ = make_();
  own_painted_.push_back(own_(frame));
}

PaintedFrame PaintingThreads::take() {
  const std::size_t number = taken_++;
  PaintedFrame painted;
  if (workers_.empty()) {
    painted = std::move(own_painted_.front());
    own_painted_.pop_front();
  } else {
    painted = *workers_[number % workers_.size()]->painted.pop();
  }
  if (painted.failure) std::rethrow_exception(painted.failure);
  return painted;
}

/// A thread that could not make its painter fails on its first frame.
void PaintingThreads::work(Worker& worker) const {
  Paint paint;
  while (const std::optional<ReadFrame> frame = worker.frames.pop()) {
    const auto first_make = [&](const ReadFrame& given) {
      if (!paint) paint = make_();
      return paint(given);
    };
    if (!worker.painted.push(paint_or_fail(first_make, *frame))) break;
  }
}

}  // namespace planecast::engine
