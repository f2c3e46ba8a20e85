// SPDX-License-Identifier: Apache-2.0
#include "segue_samples.hpp"

namespace bench {
namespace {

template <class T>
class CopyWriter final : public LoanWriter<T> {
 public:
  using LoanWriter<T>::LoanWriter;
  bool send(std::uint64_t number) override {
    sample_->number = number;
    sample_->sent_ns = clock_ns();
    return this->output().write(*sample_) == segue::task::WriteResult::Written;
  }

 private:
  std::unique_ptr<T> sample_ = std::make_unique<T>();
};

template <class T>
std::unique_ptr<Writer> open_writer(const End& end, SegueWay way) {
  if (way == SegueWay::Copied) return std::make_unique<CopyWriter<T>>(end.socket, end.bytes);
  return std::make_unique<LoanWriter<T>>(end.socket, end.bytes);
}

class Segue final : public Transport {
 public:
  explicit Segue(SegueWay way) : way_(way) {}

  [[nodiscard]] std::string name() const override {
    switch (way_) {
      case SegueWay::Loaned:
        return "segue, loaned";
      case SegueWay::Copied:
        return "segue, written (one copy)";
      case SegueWay::Flat:
        return "segue, a vector inside (flat, two copies)";
      case SegueWay::Spinning:
        return "segue, loaned, reader spins for 10 ms";
    }
    return {};
  }
  [[nodiscard]] bool carries(std::size_t bytes) const override { return is_block(bytes); }

  std::unique_ptr<Writer> open(const End& end) override {
    if (way_ == SegueWay::Flat) return open_writer<Grown>(end, way_);
    std::unique_ptr<Writer> writer;
    with_block(end.bytes, [&]<class T>(T*) { writer = open_writer<T>(end, way_); });
    return writer;
  }

  void read(const End& end) override {
    segue::Activity activity;
    if (way_ == SegueWay::Spinning) activity.spin = segue::kLongestSpin;
    if (way_ == SegueWay::Flat) return read_samples<Grown>(end.socket, end, activity);
    with_block(end.bytes, [&]<class T>(T*) { read_samples<T>(end.socket, end, activity); });
  }

 private:
  SegueWay way_;
};

}  // namespace

std::unique_ptr<Transport> make_segue(SegueWay way) {
  return std::make_unique<Segue>(way);
}

}  // namespace bench
