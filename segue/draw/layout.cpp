// SPDX-License-Identifier: Apache-2.0
#include <segue/draw/layout.hpp>

#include <algorithm>
#include <cmath>

namespace segue::draw {

namespace {

constexpr double kGap = 14;
constexpr double kRowGap = 40;
constexpr double kPage = 1.42;  ///< width to height, of a page that lies
constexpr double kWidest = 2.5;
constexpr int kSweeps = 8;

/// A box, or the point where a line passes through a layer.
struct Item {
  std::uint32_t layer = 0;
  double height = 0;
  double middle = 0;
  std::vector<std::uint32_t> before;
  std::vector<std::uint32_t> after;
};

class LayoutMaker {
 public:
  LayoutMaker(std::size_t boxes, std::vector<LayoutLine>& lines, double least, double lane,
              std::uint32_t per_row)
      : boxes_(boxes), lines_(lines), lane_(lane), per_row_(per_row), items_(boxes), inner_(lines.size()) {
    for (Item& item : items_)
      item.height = least;
  }

  Layout make() {
    find_layers();
    connect();
    for (int sweep = 0; sweep < kSweeps; ++sweep)
      arrange(sweep % 2 == 0);
    for (int sweep = 0; sweep < kSweeps; ++sweep)
      place(sweep % 2 == 0);
    spread();
    return result();
  }

 private:
  /// Boxes without predecessors go into the first layer, others into the one after their last predecessor.
  void find_layers() {
    std::vector<std::uint32_t> arriving(boxes_);
    std::vector<std::vector<std::uint32_t>> after(boxes_);
    for (const LayoutLine& line : lines_) {
      ++arriving[line.to];
      after[line.from].push_back(line.to);
    }
    for (std::size_t i = 0; i < boxes_; ++i) {
      for (const std::uint32_t to : after[i])
        items_[to].layer = std::max(items_[to].layer, items_[i].layer + 1);
      items_[i].height = std::max(items_[i].height, lane_ * (arriving[i] + 1));
    }
  }

  void connect() {
    for (std::size_t i = 0; i < lines_.size(); ++i) {
      LayoutLine& line = lines_[i];
      const std::uint32_t first = items_[line.from].layer;
      const std::uint32_t last = items_[line.to].layer;
      line.cut = last - first > kLongestLine || row_of(first) != row_of(last);
      if (line.cut) continue;
      std::uint32_t at = line.from;
      for (std::uint32_t layer = first + 1; layer < last; ++layer) {
        const auto next = static_cast<std::uint32_t>(items_.size());
        items_.push_back({layer, lane_ / 2, 0, {}, {}});
        inner_[i].push_back(next);
        link(at, next);
        at = next;
      }
      link(at, line.to);
    }
    for (std::uint32_t i = 0; i < items_.size(); ++i) {
      layers_.resize(std::max<std::size_t>(layers_.size(), items_[i].layer + 1));
      layers_[items_[i].layer].push_back(i);
    }
    for (const auto& layer : layers_)
      stack(layer);
  }
  [[nodiscard]] std::size_t row_of(std::uint32_t layer) const { return layer / per_row_; }

  void link(std::uint32_t from, std::uint32_t to) {
    items_[from].after.push_back(to);
    items_[to].before.push_back(from);
  }

  void stack(const std::vector<std::uint32_t>& layer) {
    double y = 0;
    for (const std::uint32_t i : layer) {
      items_[i].middle = y + items_[i].height / 2;
      y += items_[i].height + kGap;
    }
  }

  [[nodiscard]] double wanted(std::uint32_t item, bool rightwards) const {
    const auto& others = rightwards ? items_[item].before : items_[item].after;
    if (others.empty()) return items_[item].middle;
    double sum = 0;
    for (const std::uint32_t other : others)
      sum += items_[other].middle;
    return sum / static_cast<double>(others.size());
  }

  template <class Visit>
  void sweep(bool rightwards, Visit visit) {
    if (rightwards)
      std::for_each(layers_.begin(), layers_.end(), visit);
    else
      std::for_each(layers_.rbegin(), layers_.rend(), visit);
  }

  void arrange(bool rightwards) {
    std::vector<double> wants(items_.size());
    sweep(rightwards, [&](std::vector<std::uint32_t>& layer) {
      for (const std::uint32_t i : layer)
        wants[i] = wanted(i, rightwards);
      std::ranges::stable_sort(layer, {}, [&](std::uint32_t i) { return wants[i]; });
      stack(layer);
    });
  }

  /// Least squares with minimal distances: neighbours that would come too close are merged into a block.
  void place(bool rightwards) {
    struct Block {
      double sum = 0;
      std::size_t count = 0;
      [[nodiscard]] double at() const { return sum / static_cast<double>(count); }
    };
    std::vector<Block> blocks;
    sweep(rightwards, [&](std::vector<std::uint32_t>& layer) {
      blocks.clear();
      double offset = 0;
      std::vector<double> offsets;
      for (std::size_t k = 0; k < layer.size(); ++k) {
        if (k > 0) offset += (items_[layer[k - 1]].height + items_[layer[k]].height) / 2 + kGap;
        offsets.push_back(offset);
        blocks.push_back({wanted(layer[k], rightwards) - offset, 1});
        while (blocks.size() > 1 && blocks[blocks.size() - 2].at() > blocks.back().at()) {
          const Block last = blocks.back();
          blocks.pop_back();
          blocks.back().sum += last.sum;
          blocks.back().count += last.count;
        }
      }
      std::size_t k = 0;
      for (const Block& block : blocks) {
        for (std::size_t n = 0; n < block.count; ++n, ++k)
          items_[layer[k]].middle = block.at() + offsets[k];
      }
    });
  }

  /// Gives the lines that arrive at a box different heights, in the order of their origins.
  void spread() {
    std::vector<std::vector<std::size_t>> arriving(boxes_);
    for (std::size_t i = 0; i < lines_.size(); ++i)
      arriving[lines_[i].to].push_back(i);
    const auto came_from = [&](std::size_t i) {
      return inner_[i].empty() ? items_[lines_[i].from].middle : items_[inner_[i].back()].middle;
    };
    for (std::size_t box = 0; box < boxes_; ++box) {
      auto& own = arriving[box];
      if (own.empty()) continue;
      std::ranges::stable_sort(own, {}, came_from);
      double y = items_[box].middle - lane_ * static_cast<double>(own.size() - 1) / 2;
      for (const std::size_t i : own) {
        lines_[i].arrives = y;
        lines_[i].leaves = items_[lines_[i].from].middle;
        for (const std::uint32_t inner : inner_[i])
          lines_[i].via.push_back(items_[inner].middle);
        y += lane_;
      }
    }
  }

  /// The offset of the heights of each row, so that it is below the one before. The last one is where another
  /// row would begin.
  [[nodiscard]] std::vector<double> row_offsets() const {
    struct Extent {
      double top = 0;
      double bottom = 0;
    };
    std::vector<Extent> rows(layers_.empty() ? 0
                                             : row_of(static_cast<std::uint32_t>(layers_.size()) - 1) + 1);
    for (const Item& item : items_) {
      Extent& row = rows[row_of(item.layer)];
      row.top = std::min(row.top, item.middle - item.height / 2);
      row.bottom = std::max(row.bottom, item.middle + item.height / 2);
    }
    std::vector<double> offsets;
    double y = 0;
    for (const Extent& row : rows) {
      offsets.push_back(y - row.top);
      y += row.bottom - row.top + kRowGap;
    }
    offsets.push_back(y);
    return offsets;
  }

  Layout result() {
    Layout layout;
    layout.layers = static_cast<std::uint32_t>(layers_.size());
    layout.per_row = per_row_;
    const std::vector<double> offsets = row_offsets();
    const auto offset = [&](std::uint32_t box) { return offsets[row_of(items_[box].layer)]; };
    for (std::uint32_t i = 0; i < boxes_; ++i) {
      layout.layer.push_back(items_[i].layer);
      layout.height.push_back(items_[i].height);
      layout.top.push_back(items_[i].middle - items_[i].height / 2 + offset(i));
    }
    layout.bottom = std::max(0.0, offsets.back() - kRowGap);
    for (LayoutLine& line : lines_) {
      line.leaves += offset(line.from);
      line.arrives += offset(line.to);
      for (double& y : line.via)
        y += offset(line.to);
    }
    return layout;
  }

  const std::size_t boxes_;
  std::vector<LayoutLine>& lines_;
  const double lane_;
  const std::uint32_t per_row_;
  std::vector<Item> items_;                        ///< boxes first
  std::vector<std::vector<std::uint32_t>> inner_;  ///< by line
  std::vector<std::vector<std::uint32_t>> layers_;
};

}  // namespace

Layout lay_out(std::size_t boxes, std::vector<LayoutLine>& lines, double least, double lane,
               std::uint32_t per_row) {
  return LayoutMaker(boxes, lines, least, lane, per_row).make();
}

std::uint32_t layers_for_page(const Layout& one_row, double width) {
  const double height = one_row.bottom + kRowGap;
  if (one_row.layers * width <= kWidest * height) return kOneRow;
  const double layers = std::sqrt(kPage * height * one_row.layers / width);
  return static_cast<std::uint32_t>(std::max(3.0, std::ceil(layers)));
}

}  // namespace segue::draw
