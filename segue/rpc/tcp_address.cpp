// SPDX-License-Identifier: Apache-2.0
#include <segue/base/text.hpp>
#include <segue/rpc/tcp_address.hpp>

#include <algorithm>
#include <charconv>
#include <utility>

namespace segue::control {

namespace {

constexpr std::size_t kLongestHost = 253;  ///< RFC 1035

Error no_address(std::string_view text, const std::string& why) {
  return fail(ErrorCode::InvalidArgument, quote(text) + " is not a valid address: " + why +
                                              "; write it as 10.0.0.3:7000, [fe80::1]:7000 or name:7000");
}

bool is_host(std::string_view host) {
  const auto fits = [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '-' ||
           c == '.' || c == '_';
  };
  return !host.empty() && host.size() <= kLongestHost && host.front() != '-' && host.front() != '.' &&
         std::ranges::all_of(host, fits);
}

/// Whether the text is an IPv6 address, maybe with a zone after '%', which names a network interface.
bool is_ipv6(std::string_view host) {
  const std::size_t percent = host.find('%');
  const std::string_view digits = host.substr(0, percent);
  const auto fits = [](char c) {
    return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'f') || (c >= 'A' && c <= 'F') || c == ':' || c == '.';
  };
  return digits.size() <= 45 && digits.find(':') != std::string_view::npos &&
         std::ranges::all_of(digits, fits) &&
         (percent == std::string_view::npos || (host.size() <= 64 && is_host(host.substr(percent + 1))));
}

Result<std::uint16_t> port_from(std::string_view text, std::string_view whole) {
  std::uint16_t port = 0;
  const auto [end, failed] = std::from_chars(text.data(), text.data() + text.size(), port);
  if (failed != std::errc() || end != text.data() + text.size()) {
    return no_address(whole, "the port is a number from 0 to 65535");
  }
  return port;
}

}  // namespace

Result<TcpAddress> parse_tcp_address(std::string_view text, std::uint16_t default_port) {
  TcpAddress address;
  std::string_view rest;
  if (text.starts_with('[')) {
    const std::size_t end = text.find(']');
    if (end == std::string_view::npos) return no_address(text, "']' is missing");
    address.host = text.substr(1, end - 1);
    rest = text.substr(end + 1);
    if (!is_ipv6(address.host))
      return no_address(text, "what stands in brackets is not a valid IPv6 address");
  } else {
    const std::size_t colon = text.find(':');
    address.host = text.substr(0, colon);
    rest = colon == std::string_view::npos ? std::string_view() : text.substr(colon);
    if (!is_host(address.host)) return no_address(text, "that is not a valid host name");
  }
  if (rest.empty()) {
    if (default_port == 0) return no_address(text, "the port is missing");
    address.port = default_port;
    return address;
  }
  if (rest.front() != ':') return no_address(text, "after ']' comes ':' and the port");
  const auto port = port_from(rest.substr(1), text);
  if (!port) return port.error();
  address.port = *port;
  return address;
}

std::string to_string(const TcpAddress& address) {
  const bool brackets = address.host.find(':') != std::string::npos;
  return (brackets ? '[' + address.host + ']' : address.host) + ':' + std::to_string(address.port);
}

}  // namespace segue::control
