#include "engine/sequence/sequence.h"

#include "engine/sequence/image_file.h"
#include "engine/sequence/image_list_sequence.h"
#include "engine/sequence/video_sequence.h"
#include "engine/user_error.h"

namespace planecast::engine {

namespace fs = std::filesystem;

std::unique_ptr<Sequence> open_sequence(const fs::path& path, const SequenceOptions& options) {
  silence_codecs();
  std::error_code error;
  if (!fs::exists(path, error)) throw UserError(path.string() + ": no such file or folder");
  try {
    if (fs::is_directory(path) || has_image_suffix(path)) {
      return open_image_list(list_images(path), options);
    }
  } catch (const fs::filesystem_error& failure) {
    throw UserError(path.string() + ": " + failure.code().message());
  }
  return open_video(path, options);
}

}  // namespace planecast::engine
