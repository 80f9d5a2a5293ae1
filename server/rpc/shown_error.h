// SPDX-License-Identifier: Apache-2.0
#ifndef POSESPACE_RPC_SHOWN_ERROR_H_
#define POSESPACE_RPC_SHOWN_ERROR_H_

#include <cstddef>
#include <exception>
#include <string>
#include <string_view>
#include <type_traits>

#include "geometry/result.h"

namespace posespace {

// An error that may be shown to a caller.  All are as they are, except kInternal: what went wrong
// is logged under a random id, and the caller gets the id alone.
Error Shown(Error error);

// At most `most` bytes of text, cut between characters, without bytes that are not UTF-8: proto
// strings with such bytes cannot be read by the other side.
std::string CleanText(std::string_view text, std::size_t most);

// What a handler answers, with anything thrown turned into kInternal.
template <typename Handler>
auto Guarded(Handler&& handler) noexcept -> std::invoke_result_t<Handler> {
  try {
    return handler();
  } catch (const std::exception& thrown) {
    return Error{ErrorCode::kInternal, thrown.what(), {}};
  } catch (...) {
    return Error{ErrorCode::kInternal, "an exception of unknown type", {}};
  }
}

}  // namespace posespace

#endif  // POSESPACE_RPC_SHOWN_ERROR_H_
