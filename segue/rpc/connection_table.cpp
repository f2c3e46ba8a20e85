// SPDX-License-Identifier: Apache-2.0
#include <segue/rpc/connection_table.hpp>
#include <segue/rpc/detail/encryption.hpp>

#include <algorithm>
#include <map>
#include <optional>
#include <string_view>
#include <utility>

namespace segue::control {

struct ConnectionTable::Entry {
  std::string address;
  CutOff cut_off;
  std::optional<Identity> identity{};
  std::optional<std::string> person{};  ///< of a client
};

ConnectionTable::Place ConnectionTable::add(std::string address, CutOff cut_off) {
  make_room_for_stranger();
  entries_.push_back(std::make_shared<Entry>(Entry{std::move(address), std::move(cut_off)}));
  return {*this, entries_.back()};
}

std::size_t ConnectionTable::clients() const {
  return static_cast<std::size_t>(
      std::ranges::count_if(entries_, [](const auto& entry) { return entry->person.has_value(); }));
}

void ConnectionTable::make_room_for_stranger() {
  if (entries_.size() - clients() < kMostStrangers) return;
  std::map<std::string_view, std::size_t> unknown;  // numbers by addresses
  std::map<std::string_view, std::size_t> known;
  for (const auto& entry : entries_) {
    if (!entry->person) ++(entry->identity ? known : unknown)[entry->address];
  }
  const bool has_unknown = !unknown.empty();
  const auto most = std::ranges::max_element(has_unknown ? unknown : known, {}, [](const auto& item) {
                      return item.second;
                    })->first;
  const auto victim = std::ranges::find_if(entries_, [&](const auto& entry) {
    return !entry->person && entry->identity.has_value() != has_unknown && entry->address == most;
  });
  cut_off(*victim, "too many connections have not come in yet, and this was the oldest");
}

bool ConnectionTable::make_room_for_client(const std::string& person) {
  if (clients() < kMostClients) return true;
  std::map<std::string_view, std::size_t> counts;
  for (const auto& entry : entries_) {
    if (entry->person) ++counts[*entry->person];
  }
  const auto most = std::ranges::max_element(counts, {}, [](const auto& item) { return item.second; });
  const auto own = counts.find(person);
  if (most->second < (own == counts.end() ? 0 : own->second) + 2) return false;
  const auto victim = std::find_if(entries_.rbegin(), entries_.rend(), [&](const auto& entry) {
    return entry->person && *entry->person == most->first;
  });
  cut_off(*victim, "all places are taken, and others have fewer connections; this was the newest");
  return true;
}

void ConnectionTable::check(const Credentials& credentials) {
  const detail::Encryption& encryption = credentials.encryption();
  credentials.encryption().refresh();
  const Entries all = entries_;
  for (const auto& entry : all) {
    if (!entry->identity) continue;
    if (const auto refused = encryption.refusal(*entry->identity)) cut_off(entry, refused->message);
  }
}

void ConnectionTable::cut_off(const std::shared_ptr<Entry>& entry, const std::string& why) {
  // NOLINTNEXTLINE(performance-unnecessary-copy-initialization): `entry` may be in what changes now
  const std::shared_ptr<Entry> kept = entry;
  std::erase(entries_, kept);
  std::exchange(kept->cut_off, {})(why);
}

ConnectionTable::Place::Place(ConnectionTable& table, std::shared_ptr<Entry> entry)
    : table_(table), entry_(std::move(entry)) {}

ConnectionTable::Place::Place(Place&& other) noexcept = default;

ConnectionTable::Place::~Place() {
  if (entry_) std::erase(table_.entries_, entry_);
}

void ConnectionTable::Place::identify(Identity identity) {
  entry_->identity = std::move(identity);
}

bool ConnectionTable::Place::enter(const std::string& person) {
  if (is_cut_off()) return false;
  if (has_entered()) return true;
  if (!table_.make_room_for_client(person)) return false;
  entry_->person = person;
  return true;
}

void ConnectionTable::Place::cut_off_others(const std::string& person, const std::string& why) {
  const Entries all = table_.entries_;
  for (const auto& entry : all) {
    if (entry != entry_ && entry->person == person) table_.cut_off(entry, why);
  }
}

bool ConnectionTable::Place::has_entered() const {
  return entry_->person.has_value();
}

bool ConnectionTable::Place::is_cut_off() const {
  return !entry_->cut_off;
}

void ConnectionTable::Place::hand_on(CutOff cut_off) {
  if (!is_cut_off()) entry_->cut_off = std::move(cut_off);
}

}  // namespace segue::control
