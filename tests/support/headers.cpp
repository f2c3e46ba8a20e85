// SPDX-License-Identifier: Apache-2.0
// Nothing but headers.hpp, which is compiled with this.
