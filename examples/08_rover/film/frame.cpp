// SPDX-License-Identifier: Apache-2.0
#include "frame.hpp"

#include <segue/type/json.hpp>

#include <initializer_list>
#include <utility>

namespace film {
namespace {

using segue::type::Value;

segue::Error unusable(const std::string& why) {
  return segue::fail(segue::ErrorCode::ParseError, "a frame cannot be read: " + why);
}

segue::Result<std::vector<double>> read_positions(const Value& pane) {
  const Value* const list = pane.find("positions");
  if (list == nullptr || !list->is_list()) return unusable("a pane needs a list 'positions'");
  std::vector<double> positions;
  for (const Value& position : list->as_list()) {
    if (!position.is_number()) return unusable("'positions' must be numbers");
    positions.push_back(position.as_double());
  }
  return positions;
}

segue::Result<Pane> read_pane(const Value& value, double time) {
  if (!value.is_map()) return unusable("a pane must be a map");
  auto positions = read_positions(value);
  if (!positions) return std::move(positions.error());
  Pane pane;
  pane.scene = {time, std::move(*positions)};
  const std::initializer_list<std::pair<const char*, std::string*>> texts = {{"camera", &pane.camera},
                                                                             {"title", &pane.title},
                                                                             {"clock", &pane.clock},
                                                                             {"text", &pane.text},
                                                                             {"detail", &pane.detail}};
  for (const auto& [name, text] : texts) {
    const Value* const found = value.find(name);
    if (found == nullptr || !found->is_string())
      return unusable(std::string("a pane needs a text '") + name + "'");
    *text = found->as_string();
  }
  if (const Value* const done = value.find("done"); done != nullptr) {
    if (!done->is_bool()) return unusable("'done' must be true or false");
    pane.is_done = done->as_bool();
  }
  return pane;
}

}  // namespace

segue::Result<Frame> read_frame(const std::string& line) {
  const auto value = segue::type::parse_json(line);
  if (!value) return value.error();
  const Value* const time = value->is_map() ? value->find("time") : nullptr;
  if (time == nullptr || !time->is_number()) return unusable("it needs a number 'time'");
  const Value* const panes = value->find("panes");
  if (panes == nullptr || !panes->is_list() || panes->as_list().empty() ||
      panes->as_list().size() > kMostPanes)
    return unusable("it needs 'panes', one or " + std::to_string(kMostPanes));
  Frame frame;
  frame.time = time->as_double();
  for (const Value& pane : panes->as_list()) {
    auto read = read_pane(pane, frame.time);
    if (!read) return std::move(read.error());
    frame.panes.push_back(std::move(*read));
  }
  if (const Value* const note = value->find("note"); note != nullptr) {
    if (!note->is_string()) return unusable("'note' must be a text");
    frame.note = note->as_string();
  }
  return frame;
}

}  // namespace film
