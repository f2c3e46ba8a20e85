// SPDX-License-Identifier: Apache-2.0
#include <segue/base/file.hpp>
#include <segue/base/folders.hpp>
#include <segue/base/text.hpp>
#include <segue/rpc_tls/authority.hpp>
#include <segue/rpc_tls/credential_files.hpp>
#include <segue/rpc_tls/tls_context.hpp>

#include <system_error>
#include <utility>
#include <vector>

namespace segue::control {

namespace {

namespace fs = std::filesystem;

Result<fs::path> configured(const char* name) {
  auto folder = configuration_folder();
  if (!folder)
    return fail(ErrorCode::InvalidState, "there is no place for certificates; name one")
        .because_of(folder.error());
  return *folder / name;
}

/// The names in the folder that have a certificate and a key, for one use or the other.
struct Names {
  std::vector<std::string> hosts;
  std::vector<std::string> persons;
};

Names names_in(const fs::path& folder) {
  Names names;
  std::error_code ignored;
  for (const fs::path& key : glob_files(folder / "*.key")) {
    const fs::path file = fs::path(key).replace_extension(".crt");
    if (key.stem() == "ca" || !fs::exists(file, ignored)) continue;
    const auto certificate = tls::read_certificate(file);
    const auto identity = certificate ? tls::identity_of(certificate->get()) : certificate.error();
    if (identity) (identity->host ? names.hosts : names.persons).push_back(identity->name);
  }
  return names;
}

Result<std::string> choose(const fs::path& folder, CertificateUse use) {
  Names names = names_in(folder);
  auto& fitting = use == CertificateUse::Person && !names.persons.empty() ? names.persons : names.hosts;
  const std::string kind = use == CertificateUse::Host ? "a host" : "a person or a host";
  if (fitting.empty()) {
    return fail(ErrorCode::NotFound, "there is no certificate of " + kind + " with its key in " +
                                         quote(folder.string()) +
                                         "; `segue host enrol` makes one where the authority is");
  }
  if (fitting.size() == 1) return fitting.front();
  return fail(ErrorCode::InvalidArgument, "there are certificates of " + listed(fitting) + " in " +
                                              quote(folder.string()) + "; name one");
}

Result<tls::Material> read_material(const fs::path& folder, const std::string& name) {
  tls::Material material;
  auto authority = tls::read_certificate(folder / "ca.crt");
  if (!authority) return authority.error();
  auto certificate = tls::read_certificate(folder / (name + ".crt"));
  if (!certificate) return certificate.error();
  auto key = tls::read_key(folder / (name + ".key"));
  if (!key) return key.error();
  material.revoked_file = folder / "ca.crl";
  auto revoked = tls::read_revoked_list(material.revoked_file, authority->get());
  if (!revoked) return revoked.error();
  material.authority = std::move(*authority);
  material.certificate = std::move(*certificate);
  material.key = std::move(*key);
  material.revoked = std::move(*revoked);
  return material;
}

Result<void> check(const tls::Material& material, const Identity& identity, CertificateUse use,
                   const fs::path& folder) {
  const std::string which = "the certificate of " + quote(identity.name) + " in " + quote(folder.string());
  if (X509_verify(material.certificate.get(), X509_get0_pubkey(material.authority.get())) != 1) {
    return fail(ErrorCode::PermissionDenied,
                which + " was issued by another authority than that of ca.crt beside it");
  }
  if (X509_check_private_key(material.certificate.get(), material.key.get()) != 1) {
    return fail(ErrorCode::InvalidArgument, which + " does not belong to the key beside it; enrol it anew");
  }
  const auto now = std::chrono::system_clock::now();
  if (now >= identity.valid_until) {
    return fail(ErrorCode::PermissionDenied, which + " has expired at " + tls::text_of(identity.valid_until) +
                                                 "; `segue host enrol` issues a new one");
  }
  if (now < identity.valid_from) {
    return fail(
        ErrorCode::PermissionDenied,
        which + " is not valid before " + tls::text_of(identity.valid_from) + "; set this computer's clock");
  }
  if (use == CertificateUse::Host && !identity.host) {
    return fail(ErrorCode::InvalidArgument, which + " is not that of a host; enrol it with --host");
  }
  return {};
}

}  // namespace

Result<Credentials> load_credentials(const fs::path& folder, CertificateUse use, std::string_view name) {
  const auto chosen = name.empty() ? choose(folder, use) : Result<std::string>(std::string(name));
  if (!chosen) return chosen.error();
  if (!is_identifier(*chosen)) {
    return fail(ErrorCode::InvalidArgument, quote(*chosen) + " cannot be the name in a certificate");
  }
  auto material = read_material(folder, *chosen);
  if (!material) return material.error();
  auto identity = tls::identity_of(material->certificate.get());
  if (!identity) return identity.error();
  if (auto good = check(*material, *identity, use, folder); !good) return good.error();
  auto context = tls::Context::create(std::move(*material));
  if (!context) return context.error();
  return Credentials(std::move(*identity), std::move(*context));
}

Result<fs::path> credentials_folder() {
  return configured("credentials");
}

Result<fs::path> authority_folder() {
  return configured("ca");
}

}  // namespace segue::control
