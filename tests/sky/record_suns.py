#!/usr/bin/python3
"""Records where astropy (Debian: python3-astropy) sees the sun, for sun_position_test.cpp.

    /usr/bin/python3 tests/sky/record_suns.py > tests/data/suns.txt

A row has date, latitude, longitude, elevation, compass angle, and elevation with refraction (1010 hPa, 10 degrees
Celsius, dry, 0.55 um), all in degrees. UTC is taken for UT1, as `sun_position` does. Compare recorded rows with those of
an installed astropy by record_suns.py --check tests/data/suns.txt.
"""
import random
import sys
import warnings

try:
    import astropy.units as u
    from astropy.coordinates import AltAz, EarthLocation, get_body
    from astropy.time import Time
    from astropy.utils import iers
except ImportError:
    print("SKIPPED: astropy is not installed (Debian: python3-astropy)")
    sys.exit(77)

warnings.filterwarnings("ignore")
iers.conf.auto_download = False
iers.conf.iers_degraded_accuracy = "warn"


def see(dates, latitudes, longitudes):
    time = Time(dates, scale="utc")
    time.delta_ut1_utc = 0.0
    place = EarthLocation(lat=latitudes * u.deg, lon=longitudes * u.deg)
    sun = get_body("sun", time, place)
    true = sun.transform_to(AltAz(obstime=time, location=place))
    seen = sun.transform_to(AltAz(obstime=time, location=place, pressure=1010 * u.hPa, temperature=10 * u.deg_C,
                                  relative_humidity=0, obswl=0.55 * u.micron))
    return zip(true.alt.deg, true.az.deg, seen.alt.deg)


def places():
    """Every quarter of a year from 1950 to 2050, at random hours and places."""
    numbers = random.Random(7)
    for year in range(1950, 2051):
        for month in (1, 4, 7, 10):
            date = (f"{year}-{month + numbers.randrange(3):02}-{1 + numbers.randrange(28):02}"
                    f"T{numbers.randrange(24):02}:{numbers.randrange(60):02}:{numbers.randrange(60):02}")
            yield date, round(numbers.uniform(-1, 1) * 89.5, 3), round(numbers.uniform(-180, 180), 3)


def main():
    if sys.argv[1:2] == ["--check"]:
        rows = [line.split() for line in open(sys.argv[2]) if not line.startswith("#")]
        given = [(row[0].rstrip("Z"), float(row[1]), float(row[2])) for row in rows]
    else:
        given = list(places())
    found = list(see(*([row[k] for row in given] for k in range(3))))
    if sys.argv[1:2] == ["--check"]:
        worst = max(abs(float(row[3 + k]) - sun[k]) for row, sun in zip(rows, found) for k in range(3))
        print(f"largest difference from the recorded values: {worst:.6f} degrees")
        sys.exit(int(worst > 1e-4))
    print("# date latitude longitude elevation compass elevation_with_refraction")
    for (date, latitude, longitude), (elevation, compass, seen) in zip(given, found):
        print(f"{date}Z {latitude} {longitude} {elevation:.6f} {compass:.6f} {seen:.6f}")


main()
