"""The square FFT sea."""
