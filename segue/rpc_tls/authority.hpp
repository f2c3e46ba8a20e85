// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/result.hpp>
#include <segue/rpc/credentials.hpp>

#include <chrono>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace segue::control {

/// Whom to issue a certificate for.
struct Enrolment {
  using Time = std::chrono::system_clock::time_point;
  std::string name;  ///< of a person, or of the host as networks call it
  Role role = Role::Observe;
  bool host = false;
  std::chrono::hours valid{};  ///< 0: 825 days for a host, 365 for a person
  std::optional<Time> from{};  ///< otherwise an hour ago, since clocks of computers differ
  /// The DNS names and IP addresses by which browsers reach a host, beside its name.
  std::vector<std::string> addresses{};
};

struct IssuedCertificate {
  Identity identity;
  std::optional<std::chrono::system_clock::time_point> revoked;
};

/// A certificate authority: a folder (0700) with `ca.key` (0600), `ca.crt`, the list of revoked certificates
/// `ca.crl`, and all that was issued under `issued`. Whoever can read ca.key decides who may use the robots,
/// so the folder stays on one computer. Functions block; another program that changes the folder meanwhile is
/// an error (Unavailable). Files are replaced as wholes.
class Authority {
 public:
  /// Makes one with a key of its own, valid for ten years. AlreadyExists where there is one, unless
  /// `replace`: then certificates of the former one are worth nothing.
  static Result<Authority> create(const std::filesystem::path& folder, bool replace = false);
  /// NotFound (it says how to make one) where there is none.
  static Result<Authority> open(const std::filesystem::path& folder);

  /// Issues a certificate and writes NAME.key (0600), NAME.crt, ca.crt and ca.crl into `out`, ready to be
  /// copied. InvalidArgument where the name is not a valid identifier; AlreadyExists where a key for it is
  /// there, unless `replace`.
  Result<Identity> enrol(const Enrolment& enrolment, const std::filesystem::path& out, bool replace = false);
  /// Revokes the certificates of that name or serial which are not yet, and renews ca.crl. NotFound where
  /// there are none.
  Result<std::vector<Identity>> revoke(std::string_view name_or_serial);
  /// Sorted by name, then by the begin of their validity.
  [[nodiscard]] Result<std::vector<IssuedCertificate>> certificates() const;

  [[nodiscard]] const std::filesystem::path& folder() const { return folder_; }

 private:
  explicit Authority(std::filesystem::path folder) : folder_(std::move(folder)) {}
  std::filesystem::path folder_;
};

/// Where this user's authority is unless told otherwise: beside credentials_folder(), `ca`.
Result<std::filesystem::path> authority_folder();

}  // namespace segue::control
