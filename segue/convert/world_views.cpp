// SPDX-License-Identifier: Apache-2.0
#include <segue/convert/conversion_fault.hpp>
#include <segue/convert/world_views.hpp>

#include <iterator>
#include <utility>

namespace segue::convert {

namespace {

class Attached final : public task_network::UserData {
 public:
  Attached(const task_network::FactTable& facts, std::shared_ptr<const mission::WorldData> data)
      : facts_(facts), data_(std::move(data)) {}

  [[nodiscard]] task_network::CowPtr<task_network::UserData> clone() const override {
    return task_network::make_cow<Attached>(facts_, share());
  }
  void changed(const task_network::Literal& literal) override {
    if (planted(ConversionFault::ForgetsWorldData)) return;
    data_.changed(facts_.text(literal.fact), literal.value);
  }
  [[nodiscard]] std::shared_ptr<const mission::WorldData> share() const { return data_.share(); }

 private:
  const task_network::FactTable& facts_;
  mission::SharedWorldData data_;
};

}  // namespace

void attach(task_network::VersionedWorld& world, const task_network::FactTable& facts,
            const mission::AttachedData& data) {
  for (const auto& [name, attached] : data)
    world.attach(name, task_network::make_cow<Attached>(facts, attached));
}

mission::WorldView view_of(const task_network::VersionedWorld& world, const task_network::FactTable& facts,
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
