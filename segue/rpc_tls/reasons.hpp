// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/result.hpp>
#include <segue/rpc_tls/openssl.hpp>

#include <string>

/// Reasons of failures of TLS, in words for people. All functions may be called from any thread.
namespace segue::control::tls {

/// Why a certificate was refused with that result of OpenSSL's verification (X509_V_ERR_...): "it has expired
/// at ...". `certificate` is the one at fault; may be null.
std::string reason_of(int verification, X509* certificate);

/// The meaning of a failed call of OpenSSL with that error for the connection with `other`: "host 'left'".
Error explain(unsigned long code, const std::string& other);

}  // namespace segue::control::tls
