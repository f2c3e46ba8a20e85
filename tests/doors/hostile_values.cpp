// SPDX-License-Identifier: Apache-2.0
#include <doors/hostile_values.hpp>

#include <array>
#include <limits>
#include <string_view>
#include <utility>

namespace segue::doors {

namespace {

using namespace std::string_view_literals;

/// Paths and patterns out of the robot's folder, what is not a file, and what a reader could take for
/// something else than text.
constexpr std::array kTexts = {""sv,
                               "."sv,
                               ".."sv,
                               "/"sv,
                               "/etc/passwd"sv,
                               "/etc/*"sv,
                               "/proc/self/environ"sv,
                               "/proc/self/mem"sv,
                               "/dev/zero"sv,
                               "/dev/stdin"sv,
                               "file:///etc/passwd"sv,
                               "../outside/secret.yaml"sv,
                               "../outside/*"sv,
                               "up/secret.yaml"sv,
                               "up/*"sv,
                               "link.yaml"sv,
                               "pipe.yaml"sv,
                               "missions/../../outside/secret.yaml"sv,
                               "missions/../link.yaml"sv,
                               "%2e%2e/outside/secret.yaml"sv,
                               "..\\outside\\secret.yaml"sv,
                               "~/.ssh/id_ed25519"sv,
                               "$HOME"sv,
                               "**"sv,
                               "*/*/*/*/*"sv,
                               "[a-z]*"sv,
                               "{a,b}"sv,
                               "a\0b"sv,
                               "\xff\xfe"sv,
                               "\x1b[2J"sv,
                               "%s%n%n"sv,
                               "'; drop table entries; --"sv,
                               "\" or 1=1 --"sv,
                               "<script>alert(1)</script>"sv,
                               "${jndi:ldap://x}"sv,
                               "; touch owned"sv,
                               "$(touch owned)"sv,
                               "&a [*a, *a]"sv,
                               "null"sv,
                               "true"sv,
                               "-1"sv,
                               "1e999"sv,
                               "0x7fffffffffffffff"sv,
                               "{}"sv,
                               "[["sv,
                               "seamless"sv,
                               "paper"sv,
                               "stop"sv,
                               "pause"sv,
                               "into"sv,
                               "span"sv,
                               "at"sv,
                               "search"sv};

/// Files that a text can describe and that name others.
constexpr std::array kFiles = {
    "robot: rover\nmodels: [/etc/passwd, /etc/*]\n"sv,
    "robot: rover\nmodels: [../outside/secret.yaml, up/secret.yaml, link.yaml, pipe.yaml]\n"sv,
    "robot: rover\ncontrollers: ['../outside/*', 'up/*', /dev/zero]\nmissions: ['**/*', pipe.yaml]\n"sv,
    "robot: rover\nlibraries: [../../outside/evil, /tmp/evil.so, evil]\n"sv,
    "robot: rover\nhosts: {left: {address: /etc/passwd}}\n"sv,
    "network: watch\ntasks: {a: {component: /etc/passwd, config: {file: ../outside/secret.yaml}}}\n"sv,
    "network: watch\ntasks: {}\nconnections: [a.out -> ../b.in]\n"sv,
    "mission: m\nstart: a\nstates: {a: {library: ../outside/secret, on: {success: return success}}}\n"sv,
    "mission: m\nstart: a\nstates: {a: {library: up/secret, on: {success: return success}}}\n"sv,
    "mission: m\nactions: {a: {run: {script: {file: /etc/passwd}}}}\nstart: a\nstates: {a: {on: {success: "
    "return success}}}\n"sv,
    "mission: m\nactions: {a: {run: {script: |\n  open('/etc/passwd').read()\n}}}\nstart: a\n"sv,
    "transition: {from: a, to: b}\nactions: [{id: 1, kind: stop, task: witness}]\n"sv,
    "a: &a [x, x]\nb: &b [*a, *a]\nc: &c [*b, *b]\nd: [*c, *c]\n"sv};

constexpr std::array<std::int64_t, 12> kIntegers = {0,
                                                    1,
                                                    -1,
                                                    2,
                                                    7,
                                                    255,
                                                    65536,
                                                    std::numeric_limits<std::int32_t>::max(),
                                                    std::numeric_limits<std::int32_t>::min(),
                                                    std::numeric_limits<std::int64_t>::max(),
                                                    std::numeric_limits<std::int64_t>::min(),
                                                    1'000'000'000'000};
constexpr std::array<double, 8> kNumbers = {0.0,
                                            -0.0,
                                            0.5,
                                            -1.0,
                                            1e308,
                                            std::numeric_limits<double>::quiet_NaN(),
                                            std::numeric_limits<double>::infinity(),
                                            std::numeric_limits<double>::denorm_min()};
constexpr std::size_t kHugeText = 200'000;

}  // namespace

std::size_t HostileValues::below(std::size_t count) {
  return std::uniform_int_distribution<std::size_t>(0, count - 1)(random_);
}

std::string HostileValues::changed(std::string text) {
  switch (below(7)) {
    case 0:
      return "../" + text;
    case 1:
      return text + "/..";
    case 2:
      return text + "*";
    case 3:
      return text + text;
    case 4:
      return text.substr(0, text.size() / 2);
    case 5:
      std::swap(text.front(), text.back());
      return text;
    default:
      return text + '\0' + ".yaml";
  }
}

std::string HostileValues::text() {
  const std::size_t kind = below(20);
  if (kind == 0) return std::string(below(kHugeText), "x*/[\n"[below(5)]);
  if (kind <= 2) return std::string(kFiles.at(below(kFiles.size())));
  if (kind <= 8 || known_.empty()) return std::string(kTexts.at(below(kTexts.size())));
  const std::string& text = known_.at(below(known_.size()));
  return kind <= 16 || text.empty() ? text : changed(text);
}

std::int64_t HostileValues::integer() {
  if (!numbers_.empty() && flag()) return static_cast<std::int64_t>(numbers_.at(below(numbers_.size())));
  return kIntegers.at(below(kIntegers.size()));
}

double HostileValues::number() {
  return kNumbers.at(below(kNumbers.size()));
}

type::Value HostileValues::value(int depth) {
  switch (below(depth > 0 ? 8 : 5)) {
    case 0:
      return {};
    case 1:
      return flag();
    case 2:
      return integer();
    case 3:
      return number();
    case 4:
    case 5:
      return text();
    case 6: {
      type::Value::List list;
      for (std::size_t i = below(4); i > 0; --i)
        list.push_back(value(depth - 1));
      return list;
    }
    default: {
      type::ValueMap map;
      for (std::size_t i = below(4); i > 0; --i)
        map.set(text(), value(depth - 1));
      return map;
    }
  }
}

}  // namespace segue::doors
