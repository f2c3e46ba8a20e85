// SPDX-License-Identifier: Apache-2.0
#include <segue/rpc_tls/reasons.hpp>

#include <openssl/err.h>
#include <openssl/sslerr.h>
#include <openssl/x509_vfy.h>

#include <array>
#include <string_view>

namespace segue::control::tls {

namespace {

struct Alert {
  int reason;  ///< as OpenSSL numbers what the other side has sent
  std::string_view text;
};

/// The alerts by which the other side refuses our certificate, and the reasons that they mean.
constexpr std::array<Alert, 8> kRefusals = {{
    {SSL_R_TLSV13_ALERT_CERTIFICATE_REQUIRED, "it needs one"},
    {SSL_R_SSLV3_ALERT_CERTIFICATE_REVOKED, "it has been revoked"},
    {SSL_R_SSLV3_ALERT_CERTIFICATE_EXPIRED, "it has expired"},
    {SSL_R_TLSV1_ALERT_UNKNOWN_CA, "another authority has issued it"},
    {SSL_R_SSLV3_ALERT_UNSUPPORTED_CERTIFICATE, "it is not for that use"},
    {SSL_R_SSLV3_ALERT_BAD_CERTIFICATE,
     "its name is not the expected one, or it is not valid yet by the other clock"},
    {SSL_R_SSLV3_ALERT_CERTIFICATE_UNKNOWN, "it does not name one owner and one role"},
    {SSL_R_TLSV1_ALERT_ACCESS_DENIED, "its owner may not connect"},
}};

bool speaks_no_tls(int reason) {
  switch (reason) {
    case SSL_R_WRONG_VERSION_NUMBER:
    case SSL_R_HTTP_REQUEST:
    case SSL_R_HTTPS_PROXY_REQUEST:
    case SSL_R_UNSUPPORTED_PROTOCOL:
    case SSL_R_UNEXPECTED_MESSAGE:
    case SSL_R_BAD_RECORD_TYPE:
    case SSL_R_PACKET_LENGTH_TOO_LONG:
    case SSL_R_TLSV1_ALERT_PROTOCOL_VERSION:
      return true;
    default:
      return false;
  }
}

}  // namespace

std::string reason_of(int verification, X509* certificate) {
  const bool known = certificate != nullptr;
  switch (verification) {
    case X509_V_ERR_CERT_REVOKED:
      return "it has been revoked";
    case X509_V_ERR_CERT_HAS_EXPIRED:
      return "it has expired" + (known ? " at " + text_of(time_from(X509_get0_notAfter(certificate))) : "") +
             "; enrol its owner anew";
    case X509_V_ERR_CERT_NOT_YET_VALID:
      return "it is not valid" +
             (known ? " before " + text_of(time_from(X509_get0_notBefore(certificate))) : " yet") +
             "; compare the clocks of both computers";
    case X509_V_ERR_DEPTH_ZERO_SELF_SIGNED_CERT:
    case X509_V_ERR_SELF_SIGNED_CERT_IN_CHAIN:
    case X509_V_ERR_UNABLE_TO_GET_ISSUER_CERT:
    case X509_V_ERR_UNABLE_TO_GET_ISSUER_CERT_LOCALLY:
    case X509_V_ERR_UNABLE_TO_VERIFY_LEAF_SIGNATURE:
    case X509_V_ERR_CERT_SIGNATURE_FAILURE:
    case X509_V_ERR_CERT_CHAIN_TOO_LONG:
      return "another authority has issued it";
    case X509_V_ERR_INVALID_PURPOSE:
      return "it is not for that use; a server shows the certificate of a host";
    case X509_V_ERR_CRL_HAS_EXPIRED:
    case X509_V_ERR_UNABLE_TO_GET_CRL:
    case X509_V_ERR_CRL_SIGNATURE_FAILURE:
      return "our list of revoked certificates (ca.crl) is too old or another authority's; copy a new one "
             "here";
    default:
      return X509_verify_cert_error_string(verification);
  }
}

Error explain(unsigned long code, const std::string& other) {
  if (code == 0) return fail(ErrorCode::Unavailable, "the TLS connection with " + other + " broke");
  const int reason = ERR_GET_REASON(code);
  for (const Alert& alert : kRefusals) {
    if (alert.reason == reason) {
      return fail(ErrorCode::PermissionDenied,
                  other + " refuses the certificate of this program: " + std::string(alert.text));
    }
  }
  if (reason == SSL_R_PEER_DID_NOT_RETURN_A_CERTIFICATE) {
    return fail(ErrorCode::PermissionDenied, other + " has shown no certificate");
  }
  if (speaks_no_tls(reason)) {
    return fail(ErrorCode::Unsupported, other + " does not speak TLS 1.3");
  }
  const char* text = ERR_reason_error_string(code);
  return fail(ErrorCode::Unavailable, "the TLS connection with " + other +
                                          " failed: " + (text != nullptr ? text : std::to_string(code)));
}

}  // namespace segue::control::tls
