// What a page is dressed in.
#pragma once

namespace welkin::report {

extern const char* const kPageStyle;   ///< CSS, for screen and paper
extern const char* const kPageScript;  ///< shows a point's words beside the pointer and lights up its row in the table

}  // namespace welkin::report
