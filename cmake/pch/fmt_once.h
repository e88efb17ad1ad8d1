// libfmt holds fmt's formatter; without this declaration every program compiles it again. Clang
// mangles its name in another way than GCC, which compiled the library.
#pragma once

#include <fmt/format.h>

#ifndef __clang__
FMT_BEGIN_NAMESPACE
namespace detail {
extern template void vformat_to<char>(buffer<char>&, basic_string_view<char>,
                                      basic_format_args<FMT_BUFFER_CONTEXT(type_identity_t<char>)>,
                                      locale_ref);
}  // namespace detail
FMT_END_NAMESPACE
#endif
