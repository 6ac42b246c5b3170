#pragma once

#include <string>
#include <vector>

namespace planecast::engine {

/// A Markdown table that is filled row by row; its first `left` columns are aligned to the left.
class MarkdownTable {
 public:
  MarkdownTable(const std::vector<std::string>& header, std::size_t left);
  void row(const std::vector<std::string>& cells);
  const std::string& str() const { return text_; }

 private:
  std::string text_;
};

}  // namespace planecast::engine
