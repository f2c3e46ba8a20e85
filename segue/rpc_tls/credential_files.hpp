// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/result.hpp>
#include <segue/rpc/credentials.hpp>

#include <cstdint>
#include <filesystem>
#include <string_view>

namespace segue::control {

/// The use for which a program shows a certificate.
enum class CertificateUse : std::uint8_t { Person, Host };

/// Loads credentials from a folder with ca.crt, ca.crl, NAME.crt and NAME.key, as `segue host enrol` makes
/// it. Without a name, takes the only certificate there for that use; for a person also the host's where
/// there is no other. Fails where a file is missing, others can read the key (PermissionDenied), the
/// certificate has expired (it says when), is not for that use, does not belong to the key or was issued by
/// another authority.
Result<Credentials> load_credentials(const std::filesystem::path& folder, CertificateUse use,
                                     std::string_view name = {});

/// Where this user's credentials are unless told otherwise: `$XDG_CONFIG_HOME/segue/credentials`, else
/// `~/.config/segue/credentials`; `/etc/segue/credentials` for root. InvalidState where no home is known.
Result<std::filesystem::path> credentials_folder();

}  // namespace segue::control
