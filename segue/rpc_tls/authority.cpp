// SPDX-License-Identifier: Apache-2.0
#include <segue/base/descriptor.hpp>
#include <segue/base/file.hpp>
#include <segue/base/lock_file.hpp>
#include <segue/base/text.hpp>
#include <segue/rpc_tls/authority.hpp>
#include <segue/rpc_tls/issue.hpp>

#include <sys/stat.h>

#include <algorithm>
#include <cerrno>
#include <map>
#include <system_error>
#include <utility>

namespace segue::control {

namespace {

namespace fs = std::filesystem;

constexpr std::string_view kKey = "ca.key";
constexpr std::string_view kCertificate = "ca.crt";
constexpr std::string_view kRevoked = "ca.crl";
constexpr std::string_view kIssued = "issued";

/// An authority's certificate, key and list of revoked certificates.
struct Signer {
  tls::Certificate certificate;
  tls::Key key;
  tls::RevokedList revoked;
};

/// Makes a folder with mode 0700; an existing one stays as it is.
Result<void> make_folder(const fs::path& folder) {
  std::error_code failed;
  const fs::path parent = fs::absolute(folder, failed).lexically_normal().parent_path();
  fs::create_directories(parent, failed);
  if (::mkdir(folder.c_str(), 0700) == 0 || (errno == EEXIST && fs::is_directory(folder, failed))) return {};
  return system_error("cannot make the folder " + quote(folder.string()), errno);
}

/// Held while the folder's files change.
Result<Descriptor> lock_folder(const fs::path& folder) {
  auto lock = try_lock(folder / "ca.lock");
  if (!lock) return lock.error();
  if (lock->has_value()) return std::move(**lock);
  return fail(ErrorCode::Unavailable,
              "another program changes the authority in " + quote(folder.string()) + "; try again");
}

Result<Signer> load_signer(const fs::path& folder) {
  Signer signer;
  auto certificate = tls::read_certificate(folder / kCertificate);
  if (!certificate) return certificate.error();
  auto key = tls::read_key(folder / kKey);
  if (!key) return key.error();
  auto revoked = tls::read_revoked_list(folder / kRevoked, certificate->get());
  if (!revoked) return revoked.error();
  if (X509_check_private_key(certificate->get(), key->get()) != 1) {
    return tls::openssl_error(ErrorCode::InvalidState,
                              "ca.key and ca.crt in " + quote(folder.string()) + " do not belong together");
  }
  return Signer{std::move(*certificate), std::move(*key), std::move(*revoked)};
}

/// The certificates that the authority has issued; what it has not signed is left out.
Result<std::vector<Identity>> issued_in(const fs::path& folder, X509* authority) {
  std::vector<Identity> all;
  for (const fs::path& file : glob_files(folder / kIssued / "*.crt")) {
    const auto certificate = tls::read_certificate(file);
    if (!certificate) return certificate.error();
    if (X509_verify(certificate->get(), X509_get0_pubkey(authority)) != 1) continue;
    if (auto identity = tls::identity_of(certificate->get())) all.push_back(std::move(*identity));
  }
  std::ranges::sort(all, {}, [](const Identity& one) { return std::pair(one.name, one.valid_from); });
  return all;
}

Result<void> copy_of(const fs::path& from, const fs::path& to) {
  const auto content = read_file(from);
  if (!content) return content.error();
  return write_file(to, *content);
}

Result<void> check(const Enrolment& enrolment) {
  if (!is_identifier(enrolment.name) || enrolment.name == "ca" || enrolment.name.size() > 64) {
    return fail(ErrorCode::InvalidArgument,
                quote(enrolment.name) +
                    " cannot be the name in a certificate: a letter, digit or '_' first, "
                    "then letters, digits, '_', '-', '.' or ':', at most 64, and not 'ca'");
  }
  if (!enrolment.host && !enrolment.addresses.empty())
    return fail(ErrorCode::InvalidArgument, "only the certificate of a host has addresses");
  return {};
}

}  // namespace

Result<Authority> Authority::create(const fs::path& folder, bool replace) {
  std::error_code ignored;
  if (!replace && fs::exists(folder / kKey, ignored)) {
    return fail(ErrorCode::AlreadyExists, "there is an authority in " + quote(folder.string()) +
                                              " already; a new one makes its certificates worthless");
  }
  if (auto made = make_folder(folder); !made) return made.error();
  if (auto made = make_folder(folder / kIssued); !made) return made.error();
  const auto lock = lock_folder(folder);
  if (!lock) return lock.error();
  const auto key = tls::new_key();
  if (!key) return key.error();
  const auto certificate = tls::new_authority(key->get());
  if (!certificate) return certificate.error();
  const auto list = tls::new_list({}, certificate->get(), key->get(), 1);
  if (!list) return list.error();
  if (auto written = write_private_file(folder / kKey, tls::to_pem(key->get())); !written) {
    return written.error();
  }
  for (const auto& [name, text] : {std::pair(kCertificate, tls::to_pem(certificate->get())),
                                   std::pair(kRevoked, tls::to_pem(list->get()))}) {
    if (auto written = write_file(folder / name, text); !written) return written.error();
  }
  return Authority(folder);
}

Result<Authority> Authority::open(const fs::path& folder) {
  std::error_code ignored;
  if (!fs::exists(folder / kCertificate, ignored)) {
    return fail(ErrorCode::NotFound,
                "there is no authority in " + quote(folder.string()) + "; make one with `segue host init`");
  }
  if (const auto signer = load_signer(folder); !signer) return signer.error();
  return Authority(folder);
}

Result<Identity> Authority::enrol(const Enrolment& enrolment, const fs::path& out, bool replace) {
  if (auto good = check(enrolment); !good) return good.error();
  std::error_code ignored;
  const fs::path key_file = out / (enrolment.name + ".key");
  if (!replace && fs::exists(key_file, ignored)) {
    return fail(ErrorCode::AlreadyExists, "there is a key in " + quote(key_file.string()) + " already");
  }
  const auto lock = lock_folder(folder_);
  if (!lock) return lock.error();
  const auto signer = load_signer(folder_);
  if (!signer) return signer.error();
  const auto key = tls::new_key();
  if (!key) return key.error();
  const auto certificate = tls::issue(enrolment, key->get(), signer->certificate.get(), signer->key.get());
  if (!certificate) return certificate.error();
  auto identity = tls::identity_of(certificate->get());
  if (!identity) return identity;
  const std::string text = tls::to_pem(certificate->get());
  // The issued certificate is kept first, since revoking it needs that file.
  if (auto done = write_file(folder_ / kIssued / (identity->serial + ".crt"), text); !done)
    return done.error();
  if (auto made = make_folder(out); !made) return made.error();
  if (auto done = write_private_file(key_file, tls::to_pem(key->get())); !done) return done.error();
  if (auto done = write_file(out / (enrolment.name + ".crt"), text); !done) return done.error();
  for (const auto name : {kCertificate, kRevoked}) {
    if (auto done = copy_of(folder_ / name, out / name); !done) return done.error();
  }
  return identity;
}

Result<std::vector<Identity>> Authority::revoke(std::string_view name_or_serial) {
  const auto lock = lock_folder(folder_);
  if (!lock) return lock.error();
  const auto signer = load_signer(folder_);
  if (!signer) return signer.error();
  const auto issued = issued_in(folder_, signer->certificate.get());
  if (!issued) return issued.error();
  auto revoked = tls::revocations(signer->revoked.get());
  std::vector<Identity> hit;
  std::vector<std::string> names;
  for (const Identity& one : *issued) {
    names.push_back(one.name);
    if (one.name != name_or_serial && one.serial != name_or_serial) continue;
    if (std::ranges::find(revoked, one.serial, &tls::Revocation::serial) != revoked.end()) continue;
    hit.push_back(one);
    revoked.push_back({one.serial, std::chrono::system_clock::now()});
  }
  if (hit.empty() && std::ranges::find(names, name_or_serial) != names.end()) {
    return fail(ErrorCode::NotFound, "all certificates of " + quote(name_or_serial) + " are revoked already");
  }
  if (hit.empty()) {
    return fail(ErrorCode::NotFound, "no certificate of " + quote(name_or_serial) + " is in force" +
                                         did_you_mean(name_or_serial, names) +
                                         "; `segue host certificates` lists them");
  }
  const auto list = tls::new_list(revoked, signer->certificate.get(), signer->key.get(),
                                  tls::number_of(signer->revoked.get()) + 1);
  if (!list) return list.error();
  if (auto done = write_file(folder_ / kRevoked, tls::to_pem(list->get())); !done) return done.error();
  return hit;
}

Result<std::vector<IssuedCertificate>> Authority::certificates() const {
  const auto signer = load_signer(folder_);
  if (!signer) return signer.error();
  auto issued = issued_in(folder_, signer->certificate.get());
  if (!issued) return issued.error();
  std::map<std::string, tls::Time> revoked;
  for (const auto& one : tls::revocations(signer->revoked.get()))
    revoked.emplace(one.serial, one.when);
  std::vector<IssuedCertificate> all;
  for (Identity& identity : *issued) {
    const auto found = revoked.find(identity.serial);
    IssuedCertificate one{std::move(identity), std::nullopt};
    if (found != revoked.end()) one.revoked = found->second;
    all.push_back(std::move(one));
  }
  return all;
}

}  // namespace segue::control
