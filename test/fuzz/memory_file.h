#pragma once

#include <string>
#include <string_view>

#include "engine/user_error.h"

namespace planecast::fuzz {

/// The path of a file in memory that holds the bytes until the next call.
const std::string& memory_file(std::string_view bytes);

/// A folder in memory, empty at each call.
const std::string& memory_folder();
/// Writes a file, with the folders above it.
void put_file(const std::string& path, std::string_view bytes);

/// Runs a reader, whose own error is an answer like any other.
template <typename Reader>
void answer(const Reader& reader) {
  try {
    reader();
  } catch (const engine::UserError&) {
  }
}

}  // namespace planecast::fuzz
