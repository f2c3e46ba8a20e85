// SPDX-License-Identifier: Apache-2.0
#include <segue/convert/fault.hpp>
#include <segue/convert/world_views.hpp>

#include <iterator>
#include <utility>

namespace segue::convert {

namespace {

class Attached final : public cdtn::UserData {
 public:
  Attached(const cdtn::FactTable& facts, std::shared_ptr<const mission::WorldData> data)
      : facts_(facts), data_(std::move(data)) {}

  [[nodiscard]] cdtn::CowPtr<cdtn::UserData> clone() const override {
    return cdtn::make_cow<Attached>(facts_, share());
  }
  void changed(const cdtn::Literal& literal) override {
    if (planted(ConversionFault::ForgetsWorldData)) return;
    data_.changed(facts_.text(literal.fact), literal.value);
  }
  [[nodiscard]] std::shared_ptr<const mission::WorldData> share() const { return data_.share(); }

 private:
  const cdtn::FactTable& facts_;
  mission::SharedWorldData data_;
};

}  // namespace

void attach(cdtn::VersionedWorld& world, const cdtn::FactTable& facts, const mission::AttachedData& data) {
  for (const auto& [name, attached] : data)
    world.attach(name, cdtn::make_cow<Attached>(facts, attached));
}

mission::WorldView view_of(const cdtn::VersionedWorld& world, const cdtn::FactTable& facts,
                           const mission::AttachedData& data) {
  auto texts = world.texts(facts);
  mission::AttachedData seen;
  for (const auto& [name, first] : data) {
    if (const auto* attached = dynamic_cast<const Attached*>(world.attached(name)))
      seen.emplace(name, attached->share());
  }
  return {
      mission::WorldView::Facts(std::make_move_iterator(texts.begin()), std::make_move_iterator(texts.end())),
      std::move(seen)};
}

}  // namespace segue::convert
