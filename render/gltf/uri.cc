#include "render/gltf/uri.h"

#include <array>
#include <cctype>

#include "render/gltf/accessors.h"

namespace planecast::render {
namespace {

int hex_digit(char c) {
  if (c >= '0' && c <= '9') return c - '0';
  if (c >= 'a' && c <= 'f') return c - 'a' + 10;
  if (c >= 'A' && c <= 'F') return c - 'A' + 10;
  return -1;
}

std::string percent_decoded(const std::string& text) {
  std::string out;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const int high = text[i] == '%' && i + 2 < text.size() ? hex_digit(text[i + 1]) : -1;
    const int low = high >= 0 ? hex_digit(text[i + 2]) : -1;
    if (low >= 0) {
      out += static_cast<char>(16 * high + low);
      i += 2;
    } else {
      out += text[i];
    }
  }
  return out;
}

int base64_value(char c) {
  if (c >= 'A' && c <= 'Z') return c - 'A';
  if (c >= 'a' && c <= 'z') return c - 'a' + 26;
  if (c >= '0' && c <= '9') return c - '0' + 52;
  if (c == '+' || c == '-') return 62;
  if (c == '/' || c == '_') return 63;
  return -1;
}

std::optional<std::vector<unsigned char>> decode_base64(const std::string& text,
                                                        std::size_t begin) {
  std::vector<unsigned char> out;
  out.reserve((text.size() - begin) / 4 * 3);
  unsigned word = 0;
  int bits = 0;
  for (std::size_t i = begin; i < text.size(); ++i) {
    if (text[i] == '=') break;
    const int value = base64_value(text[i]);
    if (value < 0) return std::nullopt;
    word = (word << 6U | static_cast<unsigned>(value)) & 0xFFFFFFU;
    bits += 6;
    if (bits >= 8) {
      bits -= 8;
      out.push_back(static_cast<unsigned char>(word >> static_cast<unsigned>(bits) & 0xFFU));
    }
  }
  return out;
}

/// "name:" at the beginning, as RFC 3986 has schemes.
bool has_scheme(const std::string& uri) {
  const std::size_t colon = uri.find(':');
  if (colon == std::string::npos || colon == 0) return false;
  for (std::size_t i = 0; i < colon; ++i) {
    if (std::isalnum(static_cast<unsigned char>(uri[i])) == 0 && uri[i] != '+' && uri[i] != '-' &&
        uri[i] != '.') {
      return false;
    }
  }
  return true;
}

}  // namespace

bool is_data_uri(const std::string& uri) { return uri.starts_with("data:"); }

std::optional<std::vector<unsigned char>> decode_data_uri(const std::string& uri) {
  const std::size_t comma = uri.find(',');
  if (!is_data_uri(uri) || comma == std::string::npos) return std::nullopt;
  if (uri.substr(0, comma).ends_with(";base64")) return decode_base64(uri, comma + 1);
  const std::string text = percent_decoded(uri.substr(comma + 1));
  return std::vector<unsigned char>(text.begin(), text.end());
}

std::filesystem::path resolve_uri(const std::filesystem::path& folder, const std::string& uri) {
  const std::string text = percent_decoded(uri);
  const auto refuse = [&](const char* why) { throw ImportError("the URI '" + uri + "' " + why); };
  if (text.find('\0') != std::string::npos || text.empty()) refuse("names no file");
  if (has_scheme(text)) refuse("is not a file beside the model");
  if (text.front() == '/' || text.front() == '\\') refuse("is absolute");
  const std::filesystem::path relative(text);
  int depth = 0;
  for (const auto& part : relative) {
    if (part == "..") {
      if (--depth < 0) refuse("leaves the model's folder");
    } else if (part != ".") {
      ++depth;
    }
  }
  // Some exporters leave '%' as it is.
  const std::filesystem::path raw = folder / uri;
  std::error_code ignored;
  if (uri.find("..") == std::string::npos && std::filesystem::is_regular_file(raw, ignored)) {
    return raw;
  }
  return folder / relative;
}

}  // namespace planecast::render
