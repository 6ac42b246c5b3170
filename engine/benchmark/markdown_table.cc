#include "engine/benchmark/markdown_table.h"

namespace planecast::engine {

MarkdownTable::MarkdownTable(const std::vector<std::string>& header, std::size_t left) {
  row(header);
  text_ += "|";
  for (std::size_t i = 0; i < header.size(); ++i) text_ += i < left ? " :-- |" : " --: |";
  text_ += "\n";
}

void MarkdownTable::row(const std::vector<std::string>& cells) {
  text_ += "|";
  for (std::string cell : cells) {
    for (std::size_t at = 0; (at = cell.find('|', at)) != std::string::npos; at += 2) {
      cell.replace(at, 1, "\\|");
    }
    text_ += " " + cell + " |";
  }
  text_ += "\n";
}

}  // namespace planecast::engine
