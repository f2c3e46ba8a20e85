// SPDX-License-Identifier: Apache-2.0
#include <unistd.h>

#include <algorithm>
#include <cstdint>
#include <numeric>
#include <sstream>

#include "output.hpp"

namespace segue::cli {

namespace {

constexpr std::size_t kGap = 2;
/// Texts are not folded into columns that are narrower than that, if the table can go on below.
constexpr std::size_t kLeastText = 16;

/// A character of a cell as UTF-8, with the sequence that gives its colour (none: as the terminal has it).
struct Glyph {
  std::string_view text;
  std::string_view colour;
};

std::vector<Glyph> glyphs_of(std::string_view cell) {
  std::vector<Glyph> glyphs;
  std::string_view colour;
  for (std::size_t at = 0; at < cell.size();) {
    std::size_t end = at + 1;
    if (cell[at] == '\x1b') {
      end = std::min(cell.find('m', at), cell.size() - 1) + 1;
      colour = cell.substr(at, end - at);
      if (colour == "\x1b[0m") colour = {};
    } else {
      while (end < cell.size() && (static_cast<unsigned char>(cell[end]) & 0xC0U) == 0x80U)
        ++end;
      glyphs.push_back({cell.substr(at, end - at), colour});
    }
    at = end;
  }
  return glyphs;
}

std::string text_of(const Glyph* begin, const Glyph* end) {
  std::string text;
  std::string_view colour;
  for (const Glyph* glyph = begin; glyph != end; ++glyph) {
    if (glyph->colour != colour) {
      if (!colour.empty()) text += "\x1b[0m";
      text += colour = glyph->colour;
    }
    text += glyph->text;
  }
  return colour.empty() ? text : text + "\x1b[0m";
}

/// The end of the line that begins at `begin`: at a blank; after a sign within names, if that fills a
/// quarter of the line; else anywhere.
const Glyph* line_end(const Glyph* begin, std::size_t columns) {
  const Glyph* const full = begin + columns;
  for (const Glyph* end = full; end != begin; --end) {
    if (end->text == " ") return end;
  }
  for (const Glyph* end = full; end > begin + columns / 4; --end) {
    const std::string_view before = (end - 1)->text;
    if (std::string_view(":./_-,;=").find(before) != std::string_view::npos && end->text != before)
      return end;
  }
  return full;
}

std::vector<std::string> folded(const std::string& cell, std::size_t columns) {
  const auto glyphs = glyphs_of(cell);
  if (glyphs.size() <= columns) return {cell};
  std::vector<std::string> lines;
  const Glyph* const last = glyphs.data() + glyphs.size();
  for (const Glyph* begin = glyphs.data(); begin != last;) {
    const auto left = static_cast<std::size_t>(last - begin);
    const Glyph* end = left <= columns ? last : line_end(begin, columns);
    lines.push_back(text_of(begin, end));
    begin = std::find_if(end, last, [](const Glyph& glyph) { return glyph.text != " "; });
  }
  return lines;
}

std::size_t sum_of(const std::vector<std::size_t>& widths) {
  return std::accumulate(widths.begin(), widths.end(), widths.empty() ? 0 : (widths.size() - 1) * kGap);
}

}  // namespace

std::string folded_lines(const std::string& text, std::size_t columns) {
  std::istringstream lines(text);
  std::string result;
  for (std::string line; std::getline(lines, line);) {
    for (const std::string& part : folded(line, columns))
      result += part + '\n';
  }
  return result;
}

struct Table::Block {
  std::vector<std::size_t> columns;
  std::vector<std::size_t> widths;  ///< of these columns
};

std::vector<Table::Block> Table::blocks(std::size_t limit) const {
  Block whole;
  for (std::size_t c = 0; c < columns_.size(); ++c) {
    whole.columns.push_back(c);
    whole.widths.push_back(glyphs_of(columns_[c].title).size());
    for (const auto& row : rows_)
      whole.widths[c] = std::max(whole.widths[c], glyphs_of(row[c]).size());
  }
  Block narrow = whole;
  fold(narrow, limit, kLeastText);
  if (sum_of(narrow.widths) <= limit) return {narrow};
  // More than one block has room enough not to fold what is not long.
  Block wide = whole;
  fold(wide, 0, limit / 2);
  std::vector<Block> blocks(1);
  for (const std::size_t c : wide.columns) {
    if (blocks.back().columns.size() > 1 && sum_of(blocks.back().widths) + kGap + wide.widths[c] > limit)
      blocks.push_back({{0}, {wide.widths.front()}});
    blocks.back().columns.push_back(c);
    blocks.back().widths.push_back(wide.widths[c]);
  }
  for (Block& block : blocks) {
    for (std::size_t at = 0; at < block.columns.size(); ++at)
      block.widths[at] = whole.widths[block.columns[at]];
    fold(block, limit, 1);
  }
  return blocks;
}

void Table::fold(Block& block, std::size_t limit, std::size_t least) const {
  std::size_t widest = 0;
  for (const std::size_t width : block.widths)
    widest = std::max(widest, width);
  for (std::size_t most = widest; most-- > least && sum_of(block.widths) > limit;) {
    for (std::size_t at = 0; at < block.columns.size(); ++at) {
      if (columns_[block.columns[at]].align == Align::Left)
        block.widths[at] = std::min(block.widths[at], most);
    }
  }
}

void Table::add_line(const Block& block, const std::vector<std::string>& cells, std::string& text) const {
  std::vector<std::vector<std::string>> lines;
  std::size_t height = 1;
  for (std::size_t at = 0; at < block.columns.size(); ++at) {
    lines.push_back(folded(cells[block.columns[at]], block.widths[at]));
    height = std::max(height, lines.back().size());
  }
  for (std::size_t row = 0; row < height; ++row) {
    std::string line;
    for (std::size_t at = 0; at < block.columns.size(); ++at) {
      const std::string cell = row < lines[at].size() ? lines[at][row] : std::string();
      const std::string padding(block.widths[at] - glyphs_of(cell).size(), ' ');
      line += columns_[block.columns[at]].align == Align::Right ? padding + cell : cell + padding;
      line.append(kGap, ' ');
    }
    text += line.substr(0, line.find_last_not_of(' ') + 1) + '\n';
  }
}

std::string Table::text() const {
  return text(output_is_terminal() ? terminal_columns(STDOUT_FILENO) : SIZE_MAX);
}

std::string Table::text(std::size_t limit) const {
  std::vector<std::string> titles;
  for (const Column& column : columns_)
    titles.push_back(coloured(Colour::Bold, column.title));
  std::string text;
  for (const Block& block : blocks(limit)) {
    if (!text.empty()) text += '\n';
    add_line(block, titles, text);
    for (const auto& row : rows_)
      add_line(block, row, text);
  }
  return text;
}

}  // namespace segue::cli
