// What a shared library shows: the declarations of public headers, and nothing else.
#pragma once

#if defined(__GNUC__)
#define WELKIN_EXPORT [[gnu::visibility("default")]]
#else
#define WELKIN_EXPORT
#endif
