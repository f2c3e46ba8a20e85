// SPDX-License-Identifier: Apache-2.0
#include <segue/base/file.hpp>
#include <segue/base/text.hpp>
#include <segue/rpc_tls/authority.hpp>
#include <segue/rpc_tls/credential_files.hpp>

#include <fmt/core.h>
#include <pwd.h>
#include <unistd.h>

#include <array>
#include <filesystem>
#include <memory>

#include "../command.hpp"
#include "../output.hpp"

namespace segue::cli {

namespace {

namespace fs = std::filesystem;
using control::Authority;
using control::Identity;
using type::Value;

struct CertificateOptions {
  std::string authority;
  std::string out;
  std::string name;
  std::string role = "observe";
  std::string host;
  std::vector<std::string> addresses;
  std::uint32_t days = 0;
  bool is_host = false;
  bool no_host = false;
  bool force = false;
};

constexpr std::uint32_t kMostDays = 3653;  ///< as long as an authority is valid

Result<fs::path> authority_of(const CertificateOptions& options) {
  if (!options.authority.empty()) return fs::path(options.authority);
  return control::authority_folder();
}

/// "2026-11-22T01:02:03Z"
std::string moment(std::chrono::system_clock::time_point time) {
  const std::string text = iso_time(time);
  return text.substr(0, text.find('.')) + 'Z';
}

std::string_view use_of(const Identity& identity) {
  return identity.host ? "host" : "person";
}

Value to_value(const Identity& identity) {
  return Value::map({{"name", identity.name},
                     {"role", control::to_string(identity.role)},
                     {"use", use_of(identity)},
                     {"serial", identity.serial},
                     {"valid_from", moment(identity.valid_from)},
                     {"valid_until", moment(identity.valid_until)}});
}

std::string sentence(const Identity& identity) {
  return fmt::format("enrolled {} ({}{}) until {}", quote(identity.name), to_string(identity.role),
                     identity.host ? ", host" : "", moment(identity.valid_until));
}

/// Reports the error. Where files are there already, it adds the advice to use --force.
int refused(const Context& context, Error error) {
  if (error.code == ErrorCode::AlreadyExists) error.message += "; --force replaces it";
  return failed(context, error);
}

std::string present_user() {
  std::array<char, 4096> buffer{};
  passwd entry{};
  passwd* found = nullptr;
  ::getpwuid_r(::geteuid(), &entry, buffer.data(), buffer.size(), &found);
  return found != nullptr ? std::string(found->pw_name) : "user" + std::to_string(::geteuid());
}

std::string present_host() {
  std::array<char, 256> name{};
  if (::gethostname(name.data(), name.size() - 1) != 0) return {};
  const std::string text = name.data();
  return text.substr(0, text.find('.'));
}

/// The certificates that init issues: the user's and, unless told otherwise, the host's.
Result<std::vector<control::Enrolment>> first_enrolments(const CertificateOptions& options) {
  std::vector<control::Enrolment> all{{.name = present_user(), .role = control::Role::Administer}};
  if (options.no_host) return all;
  const std::string host = options.host.empty() ? present_host() : options.host;
  if (host == all.front().name) {
    return fail(ErrorCode::InvalidArgument, "user and host are both called " + quote(host) +
                                                "; give the host another name with --host, or --no-host");
  }
  all.push_back({.name = host, .role = control::Role::Observe, .host = true});
  return all;
}

/// NotFound unless none of these names has a key in `out`.
Result<void> check_free(const std::vector<control::Enrolment>& enrolments, const fs::path& out) {
  std::error_code ignored;
  for (const auto& enrolment : enrolments) {
    const fs::path key = out / (enrolment.name + ".key");
    if (!is_identifier(enrolment.name)) {
      return fail(
          ErrorCode::InvalidArgument,
          quote(enrolment.name) + " cannot be the name in a certificate; give the host one with --host");
    }
    if (fs::exists(key, ignored)) {
      return fail(ErrorCode::AlreadyExists, "there is a key in " + quote(key.string()) + " already");
    }
  }
  return {};
}

int init_authority(const CertificateOptions& options, const Context& context) {
  const auto folder = authority_of(options);
  if (!folder) return failed(context, folder.error());
  const auto out = options.out.empty() ? control::credentials_folder() : Result<fs::path>(options.out);
  if (!out) return failed(context, out.error());
  const auto enrolments = first_enrolments(options);
  if (!enrolments) return failed(context, enrolments.error());
  const auto free = options.force ? Result<void>() : check_free(*enrolments, *out);
  if (!free) return refused(context, free.error());
  auto authority = Authority::create(*folder, options.force);
  if (!authority) return refused(context, authority.error());
  Value::List issued;
  std::string lines;
  for (const auto& enrolment : *enrolments) {
    const auto identity = authority->enrol(enrolment, *out, options.force);
    if (!identity) return refused(context, identity.error());
    issued.push_back(to_value(*identity));
    lines += sentence(*identity) + '\n';
  }
  if (context.json()) {
    print_json(Value::map(
        {{"authority", folder->string()}, {"folder", out->string()}, {"certificates", std::move(issued)}}));
    return kDone;
  }
  print(
      fmt::format("made an authority in {}; whoever can read its ca.key decides who may use the robots\n{}"
                  "their certificates and keys are in {}\n"
                  "next: `segue host enrol NAME --host` for another computer, `segue host enrol NAME --role "
                  "operate` for a person\n",
                  quote(folder->string()), lines, quote(out->string())));
  return kDone;
}

int enrol(const CertificateOptions& options, const Context& context) {
  const auto folder = authority_of(options);
  if (!folder) return failed(context, folder.error());
  auto authority = Authority::open(*folder);
  if (!authority) return failed(context, authority.error());
  const auto role = control::role_from(options.role);
  if (!role) return failed(context, role.error());
  const control::Enrolment enrolment{.name = options.name,
                                     .role = *role,
                                     .host = options.is_host,
                                     .valid = std::chrono::hours(24) * options.days,
                                     .addresses = options.addresses};
  const fs::path out = options.out.empty() ? fs::path(options.name) : fs::path(options.out);
  const auto identity = authority->enrol(enrolment, out, options.force);
  if (!identity) return refused(context, identity.error());
  if (context.json()) {
    Value value = to_value(*identity);
    value.as_map().set("folder", out.string());
    print_json(value);
    return kDone;
  }
  print(
      fmt::format("{}\nits files are in {}; copy them to where it works, for example:\n"
                  "  scp -r {}/. {}:.config/segue/credentials/\nthen delete them here\n",
                  sentence(*identity), quote(out.string()), out.string(),
                  identity->host ? identity->name : identity->name + "@COMPUTER"));
  return kDone;
}

/// Renews this user's own copy of the list, if it is of this authority, so that only the other copies must be
/// replaced by hand.
Result<void> renew_own_list(const fs::path& authority) {
  const auto own = control::credentials_folder();
  if (!own) return {};
  const auto theirs = read_file(authority / "ca.crt");
  const auto ours = read_file(*own / "ca.crt");
  if (!theirs || !ours || *theirs != *ours) return {};
  const auto list = read_file(authority / "ca.crl");
  if (!list) return list.error();
  return write_file(*own / "ca.crl", *list);
}

int revoke(const CertificateOptions& options, const Context& context) {
  const auto folder = authority_of(options);
  if (!folder) return failed(context, folder.error());
  auto authority = Authority::open(*folder);
  if (!authority) return failed(context, authority.error());
  const auto revoked = authority->revoke(options.name);
  if (!revoked) return failed(context, revoked.error());
  const fs::path list = *folder / "ca.crl";
  if (auto done = renew_own_list(*folder); !done) return failed(context, done.error());
  Value::List values;
  for (const Identity& identity : *revoked) {
    values.push_back(to_value(identity));
    if (!context.json()) {
      print_line(fmt::format("revoked {} ({}), certificate {}", quote(identity.name),
                             to_string(identity.role), identity.serial));
    }
  }
  if (context.json()) {
    print_json(Value::map({{"revoked", std::move(values)}, {"list", list.string()}}));
  } else {
    print_line(
        fmt::format("hosts refuse it once they have the new list: copy {} over ca.crl in the credentials "
                    "folder of each",
                    quote(list.string())));
  }
  return kDone;
}

int list_certificates(const CertificateOptions& options, const Context& context) {
  const auto folder = authority_of(options);
  if (!folder) return failed(context, folder.error());
  const auto authority = Authority::open(*folder);
  if (!authority) return failed(context, authority.error());
  const auto all = authority->certificates();
  if (!all) return failed(context, all.error());
  Value::List values;
  Table table({{"name"}, {"role"}, {"use"}, {"valid until"}, {"revoked"}});
  for (const auto& one : *all) {
    const Identity& identity = one.identity;
    Value value = to_value(identity);
    value.as_map().set("revoked", one.revoked ? Value(moment(*one.revoked)) : Value());
    values.push_back(std::move(value));
    table.add({identity.name, std::string(to_string(identity.role)), std::string(use_of(identity)),
               moment(identity.valid_until), one.revoked ? moment(*one.revoked) : "-"});
  }
  context.json() ? print_json(Value(std::move(values))) : print(table.text());
  return kDone;
}

void add_authority_option(Verb& verb, CertificateOptions& options) {
  verb.option("--authority FOLDER", options.authority,
              "the authority's folder; otherwise $XDG_CONFIG_HOME/segue/ca, ~/.config/segue/ca or, for root, "
              "/etc/segue/ca");
}

void add_enrol(Verb& host, Context& context) {
  const auto options = std::make_shared<CertificateOptions>();
  Verb& verb = add_verb(host, context, "enrol", "issue a certificate for a person or a computer",
                        "  segue host enrol left --host\n  segue host enrol ann --role operate --days 30",
                        [options, &context] { return enrol(*options, context); });
  verb.option("NAME", options->name, "the person's name, or the host's as networks call it").required();
  verb.option("--role ROLE", options->role,
              "observe (default): look; operate: also switch, set and call; administer: also start processes")
      .one_of({"observe", "operate", "administer"});
  verb.flag("--host", options->is_host, "the certificate of a computer on which `segue host` will run");
  verb.option("--address ADDRESS", options->addresses,
              "of a host: an IP address or a name by which browsers reach `segue studio` there; may be "
              "repeated");
  verb.option("--days N", options->days,
              "how long it is valid; otherwise 825 days for a host, 365 for a person")
      .between(1, kMostDays);
  verb.option("--out FOLDER", options->out, "where to write the files; otherwise a folder NAME here");
  verb.flag("--force", options->force, "replace a key that is there");
  add_authority_option(verb, *options);
}

}  // namespace

void add_host_certificates(Verb& host, Context& context) {
  const auto options = std::make_shared<CertificateOptions>();
  Verb& init =
      add_verb(host, context, "init", "make an authority that issues certificates, and the first ones",
               "  segue host init\n  segue host init --host left",
               [options, &context] { return init_authority(*options, context); });
  const auto named =
      init.option("--host NAME", options->host, "this computer's name in networks; otherwise its host name");
  init.flag("--no-host", options->no_host, "no certificate for this computer").excludes(named);
  init.option("--out FOLDER", options->out,
              "where to write the certificates; otherwise credentials beside the authority's folder");
  init.flag("--force", options->force, "replace the authority and keys that are there");
  add_authority_option(init, *options);

  add_enrol(host, context);

  const auto revoked = std::make_shared<CertificateOptions>();
  Verb& revoker =
      add_verb(host, context, "revoke", "make the certificates of a name worthless",
               "  segue host revoke ann", [revoked, &context] { return revoke(*revoked, context); });
  revoker.option("NAME", revoked->name, "the name, or the serial number of one certificate").required();
  add_authority_option(revoker, *revoked);

  const auto listed = std::make_shared<CertificateOptions>();
  Verb& lister = add_verb(host, context, "certificates", "list what the authority has issued",
                          "  segue host certificates",
                          [listed, &context] { return list_certificates(*listed, context); });
  add_authority_option(lister, *listed);
}

}  // namespace segue::cli
