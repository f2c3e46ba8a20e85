// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/rpc_tls/authority.hpp>
#include <segue/rpc_tls/openssl.hpp>

#include <vector>

/// Certificates and lists that an authority signs. All functions may be called from any thread.
namespace segue::control::tls {

/// A key on the curve P-256.
Result<Key> new_key();
/// The certificate of an authority itself, under a name that no other has.
Result<Certificate> new_authority(EVP_PKEY* key);
/// A certificate for `subject_key`, signed by the authority.
Result<Certificate> issue(const Enrolment& enrolment, EVP_PKEY* subject_key, X509* authority, EVP_PKEY* key);
/// A list of revoked certificates. `number` grows with each list.
Result<RevokedList> new_list(const std::vector<Revocation>& revoked, X509* authority, EVP_PKEY* key,
                             long number);
/// The number of a list; 0 where it has none.
long number_of(X509_CRL* list);

}  // namespace segue::control::tls
