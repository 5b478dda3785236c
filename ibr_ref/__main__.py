"""`python -m ibr_ref`: the command line, where `ibr-ref` is not on the path."""

from ibr_ref.cli import main

if __name__ == "__main__":
    main()
