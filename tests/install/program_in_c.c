/* A program in C that an installed Welkin is linked with: the light of an even lat-long, and with -DWITH_FILES what is
 * said of a file that is not there. */
#include <stdio.h>
#include <welkin/welkin.h>

enum { WIDTH = 8, HEIGHT = 4 };

int main(void) {
  static float pixels[3 * WIDTH * HEIGHT];
  static welkin_projection light;
  welkin_environment view;
  int i;
  for (i = 0; i < 3 * WIDTH * HEIGHT; ++i) pixels[i] = 1.0F;
  WELKIN_INIT(view);
  WELKIN_INIT(light);
  view.format = WELKIN_FORMAT_RGB_F32;
  view.faces[0] = pixels;
  view.width = WIDTH;
  view.height = HEIGHT;
  if (welkin_project(&view, 1, NULL, NULL, &light) != WELKIN_OK) {
    fprintf(stderr, "%s\n", welkin_last_error());
    return 1;
  }
  printf("%.6f\n", light.coefficients[0]); /* the square root of 4 pi */
  if (light.coefficients[0] < 3.5449 || light.coefficients[0] > 3.5450) return 2;
#ifdef WITH_FILES
  if (welkin_project_file("no such file.exr", NULL, NULL, NULL, &light) != WELKIN_FILE_ACCESS) return 3;
#endif
  return 0;
}
