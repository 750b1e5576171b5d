//! Products of SI units, read from their symbols.

use crate::{Product, scale, table};

impl Product {
    /// Reads a product of SI units without prefixes, such as `N m`, `rad/s2` or `1/(V s)`; `None` for anything else.
    #[must_use]
    pub fn of_symbol(symbol: &str) -> Option<Self> {
        let scale = scale::read(symbol, table::Words::All)?;
        (scale.factor == 1.0 && scale.offset == 0.0).then_some(scale.product)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Unit;

    #[test]
    fn every_unit_of_channels_is_read_and_written_as_it_was() {
        for unit in Unit::ALL {
            let read = Product::of_symbol(unit.symbol()).map(|product| product.to_string());
            assert_eq!(read.as_deref(), Some(unit.symbol()));
        }
        assert_eq!(Product::of_symbol("furlong"), None);
    }

    #[test]
    fn products_and_quotients_have_their_units() {
        let unit = |text: &str| Product::of_symbol(text).unwrap();
        let said = |product: Product| product.to_string();
        assert_eq!(said(unit("N m") * unit("rad/s")), "W");
        assert_eq!(said(unit("V") * unit("A")), "W");
        assert_eq!(said(unit("N m") / Product::SECOND), "N m/s");
        assert_eq!(said(unit("W") * Product::SECOND), "J");
        assert_eq!(said(unit("rad/s") * Product::SECOND), "rad");
        assert_eq!(said(unit("rad/s") / Product::SECOND), "rad/s2");
        assert_eq!(said(unit("N m") / unit("rad")), "N m/rad");
        assert_eq!(said(unit("rad/s") / unit("rad/s")), "1");
        assert_eq!(said(unit("1") / unit("V") / Product::SECOND), "1/(V s)");
        assert_eq!(unit("1/(V s)"), unit("1") / unit("V") / Product::SECOND);
    }
}
