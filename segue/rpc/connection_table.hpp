// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/clock.hpp>
#include <segue/rpc/credentials.hpp>

#include <cstddef>
#include <functional>
#include <memory>
#include <string>
#include <vector>

namespace segue::control {

/// The connections of one server, and which of them may stay: the one policy of all servers that people and
/// programs connect to, whatever protocol they speak.
/// - Strangers are those that have not come in yet. There are kMostStrangers at most; when one more connects,
///   the address that has the most of them loses its oldest. Those that have shown a certificate come last.
///   So connections that are silent, or are refused, keep nobody out. A server gives each kTimeToEnter.
/// - Clients are those that have come in, kMostClients at most. Where all these places are taken, whoever has
///   at least two more than a newcomer loses the one that came last; where nobody has, the newcomer is
///   refused. So the connections of one person keep no other person out.
/// - Who has shown a certificate is cut off when that is revoked or expires: servers call check() every
///   kWatchPeriod at the latest.
/// For use by one thread.
class ConnectionTable {
 public:
  static constexpr std::size_t kMostStrangers = 64;
  static constexpr std::size_t kMostClients = 64;
  static constexpr Duration kTimeToEnter = std::chrono::seconds(5);
  static constexpr Duration kWatchPeriod = std::chrono::milliseconds(500);

  /// Ends the connection, now or soon, and says why to the log. Called once at the most, by a function of the
  /// table; must not call the table itself.
  using CutOff = std::function<void(const std::string& why)>;
  class Place;

  ConnectionTable() = default;
  ConnectionTable(const ConnectionTable&) = delete;
  ConnectionTable& operator=(const ConnectionTable&) = delete;

  /// A connection that was accepted, from an address of a computer. May cut off another one.
  [[nodiscard]] Place add(std::string address, CutOff cut_off);
  /// Cuts off connections whose certificate has been revoked, by the newest list, or has expired.
  void check(const Credentials& credentials);
  [[nodiscard]] std::size_t clients() const;

 private:
  struct Entry;
  using Entries = std::vector<std::shared_ptr<Entry>>;

  void make_room_for_stranger();
  bool make_room_for_client(const std::string& person);
  void cut_off(const std::shared_ptr<Entry>& entry, const std::string& why);

  Entries entries_;  ///< in the order in which they were added; without those that were cut off
};

/// A connection in the table, until this is destroyed. The table must outlive it.
class ConnectionTable::Place {
 public:
  Place(Place&& other) noexcept;
  ~Place();
  Place(const Place&) = delete;
  Place& operator=(const Place&) = delete;
  Place& operator=(Place&&) = delete;

  /// The other side has proven to be the owner of that certificate.
  void identify(Identity identity);
  /// The other side may come in: it is a client of that person from now on, and stays one. False where there
  /// is no place for it, or it was cut off.
  [[nodiscard]] bool enter(const std::string& person);
  /// Cuts off all other connections of that person.
  void cut_off_others(const std::string& person, const std::string& why);
  [[nodiscard]] bool has_entered() const;
  [[nodiscard]] bool is_cut_off() const;
  /// In place of what add() got, where the connection has been handed on.
  void hand_on(CutOff cut_off);

 private:
  friend class ConnectionTable;
  Place(ConnectionTable& table, std::shared_ptr<Entry> entry);

  ConnectionTable& table_;
  std::shared_ptr<Entry> entry_;
};

}  // namespace segue::control
