// What a shared library shows: the declarations of public headers.
#pragma once

#if defined(__GNUC__)
#define WELKIN_EXPORT [[gnu::visibility("default")]]
#define WELKIN_HIDDEN [[gnu::visibility("hidden")]]  // of a class that public headers name and no user calls
#else
#define WELKIN_EXPORT
#define WELKIN_HIDDEN
#endif
