"""Two environments side by side: exposure, light on matte spheres, reflections, and where they differ.

    python compare_two.py [FOLDER] [--first a.hdr] [--second b.hdr]
"""
import numpy as np
from _common import arguments, sphere, light_of, number, plt, save, show, srgb

import welkin


def matte(light, level):
    normals, inside = sphere(192)
    return np.dstack([srgb(0.25 * light.radiance.irradiance()(normals) / np.pi / level), inside])


def main():
    options = arguments(__doc__.splitlines()[0], "first", "second")
    images = [light_of(options.first, 8.0, 100.0), light_of(options.second, 45.0, -40.0)]
    names = [path.stem if path else f"sky, sun at {height}°"
             for path, height in ((options.first, 8), (options.second, 45))]  # fmt: skip
    lights = [welkin.bake(pixels, specular={"size": 128, "mips": 5}, brdf=False) for pixels in images]
    levels = [light.radiance.mean @ (0.2126, 0.7152, 0.0722) for light in lights]

    figure, rows = plt.subplots(3, 4, figsize=(12, 6), gridspec_kw={"width_ratios": [2, 1, 2, 2]}, layout="constrained")
    for row, light, pixels, name, level in zip(rows, lights, images, names, levels):
        show(row[0], pixels, f"{name}: mean {number(level)}", 192)
        row[1].imshow(matte(light, level))
        row[1].set_title("a matte sphere", fontsize=8)
        row[1].set_axis_off()
        for axes, mip in zip(row[2:], (2, 3)):
            show(axes, light.specular[mip], f"roughness {light.specular.mips[mip].roughness:.2f}", 192)
    # Both at the same mean: what is left is shape and colour.
    equal = [welkin.to_lat_long(light.specular[1], 192) / level for light, level in zip(lights, levels)]
    difference = (equal[1] - equal[0]) @ (0.2126, 0.7152, 0.0722)
    drawn = rows[2][0].imshow(difference, cmap="RdBu", vmin=-2, vmax=2)
    rows[2][0].set_title("second less first, at equal means", fontsize=8)
    figure.colorbar(drawn, ax=rows[2][0], fraction=0.025).ax.tick_params(labelsize=7)
    bands = np.array([[np.linalg.norm(light.radiance.coefficients[l * l : (l + 1) ** 2]) for l in range(3)]
                      for light in lights])  # fmt: skip
    bands /= bands[:, :1]
    for offset, (values, name) in enumerate(zip(bands, names)):
        rows[2][2].bar(np.arange(3) + 0.4 * offset - 0.2, values, 0.4, label=name)
    rows[2][2].set(title="energy of each band of harmonics, over the first's", xticks=range(3))
    rows[2][2].title.set_fontsize(8)
    rows[2][2].tick_params(labelsize=7)
    rows[2][3].legend(*rows[2][2].get_legend_handles_labels(), loc="center left", fontsize=8, frameon=False)
    for axes in (rows[2][0], rows[2][1], rows[2][3]):
        axes.set_axis_off()
    save(figure, options.folder, "compare_two.png")


if __name__ == "__main__":
    main()
