// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <boost/beast/core/string.hpp>
#include <boost/beast/http.hpp>

#include <string>
#include <utility>

/// The HTTP responses to browsers.
namespace segue::web::detail {

using HttpRequest = boost::beast::http::request<boost::beast::http::empty_body>;
using HttpResponse = boost::beast::http::response<boost::beast::http::string_body>;

/// Nothing but the page's own files, no frames around it, nothing about it to others.
inline void add_policies(HttpResponse& response) {
  response.set(
      "Content-Security-Policy",
      "default-src 'none'; script-src 'self'; worker-src 'self'; style-src 'self'; img-src 'self' data:; "
      "font-src 'self'; connect-src 'self'; base-uri 'none'; form-action 'none'; frame-ancestors 'none'");
  response.set("X-Content-Type-Options", "nosniff");
  response.set("X-Frame-Options", "DENY");
  response.set("Referrer-Policy", "no-referrer");
  response.set("Cross-Origin-Opener-Policy", "same-origin");
  response.set("Cross-Origin-Resource-Policy", "same-origin");
  response.set(boost::beast::http::field::cache_control, "no-store");
}

inline HttpResponse response_of(const HttpRequest& request, boost::beast::http::status status,
                                boost::beast::string_view type, std::string body) {
  HttpResponse response(status, request.version());
  add_policies(response);
  response.set(boost::beast::http::field::content_type, type);
  response.keep_alive(request.keep_alive());
  response.body() = std::move(body);
  response.prepare_payload();
  if (request.method() == boost::beast::http::verb::head) response.body().clear();
  return response;
}

/// `head` and `text` are markup.
inline std::string message_page(const std::string& head, const std::string& text) {
  return "<!doctype html><html lang=\"en\"><head><meta charset=\"utf-8\"><title>Segue Studio</title>" + head +
         "</head><body><p>" + text + "</p></body></html>\n";
}

}  // namespace segue::web::detail
